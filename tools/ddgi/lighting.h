// Direct light on a surface, with shadow rays.
#pragma once

#include "ray_scene.h"

namespace gicodec::ddgi {

/// Irradiance over π that the scene's lights give a surface: times albedo it is the reflected
/// radiance. Shadow rays are counted into `rays`.
[[nodiscard]] Vec3 direct_light(const RayScene& scene, const Surface& surface, std::uint64_t& rays);

}  // namespace gicodec::ddgi
