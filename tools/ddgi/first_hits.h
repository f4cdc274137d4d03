// What can be seen from a point: positions for the selection of probes a client needs (Stengel et
// al. §3.4, client view probe culling).
#pragma once

#include "ray_scene.h"

#include <vector>

namespace gicodec::ddgi {

struct FirstHit {
  Vec3 position, normal;  ///< the normal looks towards the viewer
  float distance = 0;
};

/// First hits of `count` directions spread evenly over the sphere around `eye`. Directions that
/// leave the scene have no entry. Thread-safe beside other queries.
[[nodiscard]] std::vector<FirstHit> first_hits(const RayScene& scene, Vec3 eye,
                                               std::uint32_t count);

}  // namespace gicodec::ddgi
