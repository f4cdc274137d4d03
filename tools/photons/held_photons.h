// The photons that a client holds, checked, expired and normalised.
#pragma once

#include "kinds/traced_kind.h"

#include <gicodec/photons.h>

#include <vector>

namespace gicodec::photons {

struct HeldPhoton {
  ddgi::Vec3 position, direction;
  ddgi::Vec3 flux;   ///< for one photon emitted by its light
  float radius = 0;  ///< positive; all are finite
};

/// Batches of a light are seen as so many estimates of the same light, and averaged. One that its
/// light has left behind by so many states, modulo 2^16, counts for half as much for each of them,
/// and expires after kOldest: until new batches replace it, old light fades.
inline constexpr std::uint16_t kOldest = 7;
/// That can be drawn.
inline constexpr std::uint32_t kMaxBatches = 1U << 16;

class HeldPhotons {
 public:
  struct Batch {
    std::size_t hash = 0;  ///< of the bytes that it was unpacked from; 0: of none
    PhotonBatch batch;
    std::vector<HeldPhoton> photons;
    float scale =
        0;  ///< of flux: share of its light's average over the photons it emitted; 0: expired
  };

  /// Throws tools::Error of Exit::bad_input unless the volume is one of photons, with blocks one
  /// after the other.
  explicit HeldPhotons(const VolumeDesc& desc);

  /// Textures of such a volume. Photons and batches with numbers that are not finite, or negative
  /// where that means nothing, are passed over. Throws tools::Error of Exit::bad_input for textures
  /// of other sizes.
  void update(const kinds::HeldVolume& volume);
  [[nodiscard]] std::span<const Batch> batches() const noexcept { return batches_; }

 private:
  void unpack(std::span<const std::byte> head, std::span<const std::byte> records,
              Batch& batch) const;
  void expire();

  VolumeDesc desc_;
  PhotonForm form_ = PhotonForm::halves;
  std::uint32_t capacity_ = 0;  ///< of a batch
  std::vector<Batch> batches_;
};

}  // namespace gicodec::photons
