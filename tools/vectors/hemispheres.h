// Six irradiance vectors at a point, and how they are kept (Pacanowski et al. §3.1, §3.3).
#pragma once

#include "ddgi/vec.h"

#include <array>
#include <cstddef>

namespace gicodec::vectors {

using ddgi::Vec3;

inline constexpr std::size_t kHemispheres = 6;  ///< around +x, −x, +y, −y, +z, −z

using ddgi::axis_of;

/// Irradiance vectors of red, green and blue over one hemisphere, divided by π.
struct Vectors {
  Vec3 red, green, blue;

  /// Irradiance over π of a surface with the unit vector `normal`.
  [[nodiscard]] constexpr Vec3 along(Vec3 normal) const {
    return {dot(red, normal), dot(green, normal), dot(blue, normal)};
  }
  friend constexpr bool operator==(const Vectors&, const Vectors&) = default;
};

/// One direction for all colours.
struct DirectedColor {
  Vec3 direction, color;

  [[nodiscard]] constexpr Vectors vectors() const {
    return {direction * color.x, direction * color.y, direction * color.z};
  }
};

/// §3.3: along the hemisphere's axis nothing is lost. Without light the direction is the axis.
[[nodiscard]] DirectedColor compress(const Vectors& vectors, std::size_t hemisphere);

/// Records of the kind: quantised, or floats.
class VectorCode {
 public:
  explicit VectorCode(bool floats) : floats_(floats) {}
  [[nodiscard]] std::size_t bytes() const { return floats_ ? 24 : 7; }
  void store(std::byte* record, const DirectedColor& value) const;
  /// Of any bits: finite, and colours are not negative.
  [[nodiscard]] DirectedColor load(const std::byte* record) const;

 private:
  bool floats_;
};

}  // namespace gicodec::vectors
