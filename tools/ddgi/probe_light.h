// Light around a probe in the forms that engines' textures are filled from.
#pragma once

#include "sh.h"
#include "vec.h"

#include <array>
#include <span>

namespace gicodec::ddgi {

struct ProbeRay;

struct ProbeLight {
  ShFactors sh{};            ///< of irradiance over π
  std::array<Vec3, 6> cube;  ///< irradiance over π on faces towards -x, +x, -y, +y, -z, +z
  /// Share of a face's light that a sky of radiance 1 would give: the factors of 1, x, y, z.
  std::array<float, 4> sky{};
  float sun = 0;  ///< 1 where the sun is seen

  friend bool operator==(const ProbeLight&, const ProbeLight&) = default;
};

/// Of what rays bring; those that see insides do not count.
[[nodiscard]] ProbeLight measure_light(std::span<const Vec3> directions,
                                       std::span<const ProbeRay> rays, float sun);
/// `hysteresis` of the old, the rest of the new.
[[nodiscard]] ProbeLight mix(const ProbeLight& light, const ProbeLight& old, float hysteresis);

}  // namespace gicodec::ddgi
