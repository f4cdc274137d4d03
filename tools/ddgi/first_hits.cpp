#include "first_hits.h"

#include "rays.h"

namespace gicodec::ddgi {

std::vector<FirstHit> first_hits(const RayScene& scene, Vec3 eye, std::uint32_t count) {
  std::vector<FirstHit> hits;
  for (const Vec3 d : fibonacci_directions(count)) {
    const auto surface = scene.intersect(eye, d, 0);
    if (!surface) continue;
    const Vec3 normal = surface->back ? -surface->normal : surface->normal;
    hits.push_back({surface->position, normal, surface->distance});
  }
  return hits;
}

}  // namespace gicodec::ddgi
