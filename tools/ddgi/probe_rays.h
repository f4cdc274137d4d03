// Rays of one probe: what they meet, what light they bring, and blending them into texels.
#pragma once

#include "probe_field.h"
#include "ray_scene.h"
#include "rays.h"

#include <span>
#include <vector>

namespace gicodec::ddgi {

enum class RayEnd : std::uint8_t { sky, front, back };

/// One traced ray. `direct` is what it brings without the volume: sky, emission, lit surface.
struct ProbeRay {
  RayEnd end = RayEnd::sky;
  float distance = 0;
  Vec3 direct, albedo, position, normal;
  Cage cage;  ///< set by find_cages()
  Fetch fetch;
  Vec3 radiance;
};

struct RayCount {
  std::uint64_t probe = 0, shadow = 0;
};

/// Traces the rays of a probe and lights what they meet; `out` has one entry per direction.
void trace_probe(const RayScene& scene, Vec3 position, std::span<const Vec3> directions,
                 std::span<ProbeRay> out, RayCount& count);
/// Looks up where the volume has to be read for the next bounce.
void find_cages(const ProbeField& field, std::span<const Vec3> directions,
                std::span<ProbeRay> rays);
/// direct + albedo · light from the volume.
[[nodiscard]] Vec3 bounce(const ProbeField& field, const ProbeRay& ray);

/// Mean radiance with cosine weights for each core texel; rays that see insides do not count.
void blend_irradiance(const RaySet& set, std::span<const ProbeRay> rays, std::span<Vec3> out);
/// Mean distance and mean squared distance; insides count as a fifth of their distance.
void blend_visibility(const RaySet& set, std::span<const ProbeRay> rays, float cap,
                      std::span<Vec2> out);

}  // namespace gicodec::ddgi
