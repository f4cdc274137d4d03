// Photons (Crassin et al. §4.3): batches of particles of indirect light, each batch shot from one
// light. The order of a batch's photons means nothing. If publishers bring each batch into
// canonical order (kPhotons.sort), updates take a fraction of the bytes where few photons changed.
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
inline constexpr std::uint32_t kMaxPhotons = kMaxBlockRecords;  ///< per batch

/// How 20 bytes store a photon (FORMAT.md, "Photons").
enum class PhotonForm : std::uint8_t {
  halves = 0,           ///< direction 8 + 8 bits, power 3 halves; "Q" in tools
  shared_exponent = 1,  ///< direction 16 + 16 bits, power RGB9E5; "R" in tools
};

/// Kind 5: one group of three bundled textures over a pool of batches: "count" (R16_UINT, the
/// number of stored photons), "batch" (PhotonBatch) and "photons" (the first `count` exist).
extern const Kind kPhotons;

/// A volume of `batches`, 1..kMaxBlocks, with room for `capacity` photons each: 1..64, a multiple
/// of 64 up to 4,096, or one of 4,096 up to kMaxPhotons; else invalid_description. Textures have
/// Tiling::blocks.
[[nodiscard]] Result<VolumeDesc> photon_volume(std::uint32_t batches, std::uint32_t capacity,
                                               PhotonForm form = PhotonForm::halves);
/// The form of a "photons" texture with that record; unsupported_format for any other record.
[[nodiscard]] Result<PhotonForm> photon_form(const Record& record) noexcept;

inline constexpr std::size_t kPhotonBytes = 20;
inline constexpr std::size_t kPhotonBatchBytes = 36;

/// What the photons of a batch share. A slot with `emitted` 0 is free.
struct PhotonBatch {
  Position minimum{}, extent{};  ///< box of the positions, world units
  float watts = 0;               ///< power of the light, mean of the channels
  std::uint16_t light = 0;       ///< number of the light that shot it
  std::uint16_t generation = 0;  ///< number of that light's state, modulo 2^16
  std::uint32_t emitted = 0;     ///< photons that left the light, stored or not

  friend bool operator==(const PhotonBatch&, const PhotonBatch&) = default;
};

/// A photon. Its flux is power · normalisation · watts / E: `watts` of its batch, and E the sum of
/// `emitted` over all batches of its light that the client uses. The light is then right however
/// many of these batches the client holds, and photons stay the same while their light only grows
/// or fades.
/// Example: of a white lamp of 60 watts that emitted 10,000 photons, a photon that met a wall of
/// albedo 0.5 has power 0.5 in each channel and a flux of 0.003 watts.
struct Photon {
  Position position{};
  std::array<float, 3> direction{0, 0, 1};  ///< of travel, unit length
  std::array<float, 3> power{};             ///< per channel, for a light of 1 watt
  float radius = 0;         ///< of the disc that the flux is spread over, world units
  float normalisation = 1;  ///< number of photons that it stands for

  friend bool operator==(const Photon&, const Photon&) = default;
};

using PhotonBytes = std::span<std::byte, kPhotonBytes>;
using ConstPhotonBytes = std::span<const std::byte, kPhotonBytes>;

// Rounding is defined to the bit (FORMAT.md, "Photons"). Packing replaces a value out of range or
// infinite by the nearest in range, and NaN by 0. Unpacking takes any bytes and gives infinities
// and NaN where they encode them. pack(unpack(bytes)) equals bytes that came from pack(), as long
// as floats distinguish the steps of the batch's box.
void pack_photon(const Photon& photon, const PhotonBatch& batch, PhotonForm form,
                 PhotonBytes out) noexcept;
[[nodiscard]] Photon unpack_photon(ConstPhotonBytes bytes, const PhotonBatch& batch,
                                   PhotonForm form) noexcept;

void pack_photon_batch(const PhotonBatch& batch,
                       std::span<std::byte, kPhotonBatchBytes> out) noexcept;
[[nodiscard]] PhotonBatch unpack_photon_batch(
    std::span<const std::byte, kPhotonBatchBytes> bytes) noexcept;

}  // namespace gicodec
