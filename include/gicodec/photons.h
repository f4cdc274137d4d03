// Photons (Crassin et al. §4.3): batches of particles of indirect light, each batch shot from one
// light. The order of the photons of a batch means nothing; kPhotons.sort brings each batch into
// the one in which they arrive, and an update after that costs a fraction where few photons
// changed.
#pragma once

#include <gicodec/api.h>
#include <gicodec/kind.h>
#include <gicodec/texture.h>
#include <gicodec/volume.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace GICODEC_API gicodec {

inline constexpr std::uint8_t kKindPhotons = 5;
inline constexpr std::uint32_t kMaxPhotons = kMaxBlockRecords;  ///< stored in one batch

/// What the 20 bytes of a photon are spent on (FORMAT.md, "Photons").
enum class PhotonForm : std::uint8_t {
  halves = 0,           ///< direction 8 + 8 bits, power 3 halves; "Q" in programs
  shared_exponent = 1,  ///< direction 16 + 16 bits, power RGB9E5; "R"
};

/// Kind 5: one set, a pool of batches, of three textures that travel together: "count" (R16_UINT,
/// stored photons), "batch" (PhotonBatch) and "photons", of which the first `count` exist.
extern const Kind kPhotons;

/// A pool of `batches`, each with room for `capacity` photons: 1 to 64, a multiple of 64 up to
/// 4,096, or one of 4,096 up to kMaxPhotons; else invalid_description. In memory each texture is an
/// array of blocks.
[[nodiscard]] Result<VolumeDesc> photon_volume(std::uint32_t batches, std::uint32_t capacity,
                                               PhotonForm form = PhotonForm::halves);
/// The form of a "photons" texture by its record; unsupported_format if it is none.
[[nodiscard]] Result<PhotonForm> photon_form(const Record& record) noexcept;

inline constexpr std::size_t kPhotonBytes = 20;
inline constexpr std::size_t kPhotonBatchBytes = 36;

/// What is said of a batch as a whole. A slot whose batch was emitted by nobody (emitted 0) is
/// free.
struct PhotonBatch {
  Position minimum{}, extent{};  ///< box of the positions, world units
  float watts = 0;               ///< power of the light that shot it, mean of the channels
  std::uint16_t light = 0;       ///< which one that is
  std::uint16_t generation = 0;  ///< state of that light, counted modulo 2^16
  std::uint32_t emitted = 0;     ///< photons that left the light, stored or not

  friend bool operator==(const PhotonBatch&, const PhotonBatch&) = default;
};

/// Flux of a photon: power · normalisation · watts / E, with the watts of its batch, and E the
/// number of photons emitted by all batches of its light that the client uses. So light is right
/// however many of them it holds, and photons stay what they are where a light only grows or fades.
/// Of a white lamp of 60 watts that emitted 10,000 photons, one that has met a wall of albedo 0.5
/// has power 0.5 in each channel, and a flux of 0.003 watts.
struct Photon {
  Position position{};
  std::array<float, 3> direction{0, 0, 1};  ///< of travel, unit length
  std::array<float, 3> power{};             ///< by channel, of a light of 1 watt
  float radius = 0;                         ///< of the disc that it stands for, world units
  float normalisation = 1;                  ///< for how many photons it stands

  friend bool operator==(const Photon&, const Photon&) = default;
};

using PhotonBytes = std::span<std::byte, kPhotonBytes>;
using ConstPhotonBytes = std::span<const std::byte, kPhotonBytes>;

// Rounding is defined to the bit (FORMAT.md, "Photons"). What is not finite or out of range is
// packed as the nearest value that is, NaN as 0; unpacking takes any bytes, and gives back
// infinities and NaN where they say so. Each code but an alias comes back: pack(unpack(bytes))
// gives bytes if bytes came from pack(), as long as floats tell the steps of the box apart.
void pack_photon(const Photon& photon, const PhotonBatch& batch, PhotonForm form,
                 PhotonBytes out) noexcept;
[[nodiscard]] Photon unpack_photon(ConstPhotonBytes bytes, const PhotonBatch& batch,
                                   PhotonForm form) noexcept;

void pack_photon_batch(const PhotonBatch& batch,
                       std::span<std::byte, kPhotonBatchBytes> out) noexcept;
[[nodiscard]] PhotonBatch unpack_photon_batch(
    std::span<const std::byte, kPhotonBatchBytes> bytes) noexcept;

}  // namespace gicodec
