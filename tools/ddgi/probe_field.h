// Diffuse light at a point from the probes around it, as a shader computes it (Majercik et al.
// 2019, §5). Used by the tracer for its next bounce and by the client for its picture.
#pragma once

#include "octahedral.h"
#include "volume.h"

#include <array>

namespace gicodec::ddgi {

/// The eight probes around a point and their normalised weights. Bit 0 of a corner's number is the
/// step in x, bit 1 in y, bit 2 in z.
struct Cage {
  std::uint32_t base = 0;
  std::array<std::uint32_t, 3> step{};  ///< index distance of the neighbour, 0 at the volume's end
  std::array<float, 8> weight{};        ///< all 0 where no active probe is near

  [[nodiscard]] std::uint32_t probe(unsigned corner) const {
    return base + (corner & 1 ? step[0] : 0) + (corner & 2 ? step[1] : 0) +
           (corner & 4 ? step[2] : 0);
  }
};

/// Probe textures unpacked for sampling. Reading is thread-safe.
class ProbeField {
 public:
  explicit ProbeField(const VolumeShape& shape);

  [[nodiscard]] const VolumeShape& shape() const { return shape_; }
  void set_color(const ProbeTextures& textures);
  /// Of one probe, by different threads for different ones. Precondition: all were set before from
  /// textures of the same form.
  void set_color(const ProbeTextures& textures, std::uint32_t probe);
  /// Also settles which probes are active: those whose visibility block is not zero.
  void set_visibility(const ProbeTextures& textures);

  /// Whether a point lies between the first and the last probe.
  [[nodiscard]] bool holds(Vec3 position) const;
  /// Weights for a surface point: trilinear × facing × Chebyshev visibility. `to_viewer` is the
  /// unit vector against the ray that found the point.
  [[nodiscard]] Cage cage(Vec3 position, Vec3 normal, Vec3 to_viewer) const;
  /// Where irradiance in a direction is read.
  [[nodiscard]] Fetch fetch(Vec3 direction) const { return bilinear_fetch(direction, color_core_); }
  /// Irradiance over π in the direction of `fetch`.
  [[nodiscard]] Vec3 irradiance(const Cage& cage, const Fetch& fetch) const;
  [[nodiscard]] Vec3 irradiance(Vec3 position, Vec3 normal, Vec3 to_viewer) const {
    return irradiance(cage(position, normal, to_viewer), this->fetch(normal));
  }

 private:
  [[nodiscard]] Vec2 moments(std::uint32_t probe, Vec3 direction) const;

  VolumeShape shape_;
  std::uint32_t color_core_ = 0, visibility_core_ = 0;
  bool linear_ = false;                      ///< what color_ holds
  std::vector<std::array<float, 4>> color_;  ///< as stored, block after block
  std::vector<Vec2> moments_;
  std::vector<std::uint8_t> active_;
};

}  // namespace gicodec::ddgi
