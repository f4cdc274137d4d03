// Light that comes to a point along rays: what tracers of all kinds have in common.
#pragma once

#include "noise.h"
#include "ray_scene.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::ddgi {

struct GatherOptions {
  std::uint32_t rays = 256;  ///< of each point
  bool turned = false;       ///< each point has them turned by chance, or all have the same
  bool anew = false;         ///< turned otherwise at every update
  std::uint32_t warmup = 3;  ///< updates before the first one, so that light has bounced
  std::uint32_t seed = 1;

  [[nodiscard]] std::uint32_t seed_of(std::uint32_t update) const {
    return hash(seed, anew ? update : 0);
  }
};

/// Calls take(index, radiance, hit) for rays that share a solid angle. `hit` is nullptr where the
/// sky is; radiance of insides is zero, that of fronts of surfaces is emission and albedo ·
/// light(hit), irradiance over π. Returns how many rays end at insides, and stops once these are
/// more than `max_inside`. Adds to `rays` how many were traced.
template <typename Light, typename Take>
std::size_t gather(const RayScene& scene, Vec3 origin, std::span<const Vec3> directions,
                   float solid_angle, std::uint64_t& rays, const Light& light, const Take& take,
                   std::size_t max_inside = SIZE_MAX) {
  const float spread = std::sqrt(solid_angle / static_cast<float>(directions.size()));
  std::size_t inside = 0;
  for (std::size_t i = 0; i < directions.size() && inside <= max_inside; ++i) {
    ++rays;
    const auto hit = scene.intersect(origin, directions[i], spread);
    if (!hit) {
      take(i, scene.state().sky.radiance(directions[i]), nullptr);
    } else if (hit->back) {
      ++inside;
      take(i, Vec3{}, &*hit);
    } else {
      take(i, hit->emission + hit->albedo * light(*hit), &*hit);
    }
  }
  return inside;
}

}  // namespace gicodec::ddgi
