// Irradiance gathered at texels of a map (Crassin et al. §4.2, steps 3 and 4): one bounce more with
// every update.
#pragma once

#include "parameterisation.h"

#include "ddgi/gather.h"
#include "ddgi/parallel.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::maps {

/// A texel's sample in the world, in the scene's present state.
struct MapPoint {
  Vec3 position, geometric_normal, normal;
};
/// A little inside of its triangle, so that it is not in the wall that the triangle meets.
[[nodiscard]] MapPoint point_of(const Parameterisation& map, const ddgi::RayScene& scene,
                                const MapTexel& texel);

struct GatherCount {
  std::uint64_t rays = 0, shadow_rays = 0;
};

/// The texels that light reaches: not those within solids that never move, as where a pillar stands
/// on a floor. The scene is at rest.
[[nodiscard]] std::vector<MapTexel> open_texels(const Parameterisation& map,
                                                const ddgi::RayScene& scene,
                                                ddgi::ThreadPool& pool);

/// Irradiance over π of direct light at some texels, by place.
void light_directly(const Parameterisation& map, const ddgi::RayScene& scene,
                    std::span<const MapTexel> at, ddgi::ThreadPool& pool, std::span<Vec3> direct,
                    GatherCount& count);

/// Irradiance over π of indirect light at some texels: the mean of what cosine-distributed rays
/// meet: the sky, or emission and albedo · `lit`, by place: direct light and the map before, of
/// texels that exist. Insides count as nothing met. The same for any number of threads.
void gather(const Parameterisation& map, const ddgi::RayScene& scene, std::span<const MapTexel> at,
            std::span<const Vec3> lit, std::span<const std::uint8_t> exists,
            const ddgi::GatherOptions& options, std::uint32_t update, ddgi::ThreadPool& pool,
            std::span<Vec3> out, GatherCount& count);

}  // namespace gicodec::maps
