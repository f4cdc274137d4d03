#include "occlusion.h"

#include "ddgi/noise.h"

#include <cmath>

namespace gicodec::ao {

using ddgi::Vec3;

Frame frame_around(Vec3 normal) {
  Frame frame{{}, {}, normal};
  ddgi::basis(normal, frame.tangent, frame.bitangent);
  return frame;
}

Hemisphere::Hemisphere(std::uint32_t rays, float distance) : turns_(rays), distance_(distance) {
  const double golden = ddgi::kPi * (3 - std::sqrt(5.0));
  for (std::uint32_t i = 0; i < rays; ++i) {
    turns_[i] = {static_cast<float>(std::cos(i * golden)),
                 static_cast<float>(std::sin(i * golden))};
  }
}

float Hemisphere::visible(const ddgi::RayScene& scene, Vec3 place, Vec3 geometric,
                          const Frame& frame, std::uint32_t seed) const {
  ddgi::Surface surface;
  surface.position = place, surface.geometric_normal = geometric;
  const Vec3 origin = leave(surface, geometric);
  const float angle = 2 * ddgi::kPi * ddgi::unit(ddgi::hash(seed));
  const float shift = ddgi::unit(ddgi::hash(seed, 1));
  const float cosine = std::cos(angle), sine = std::sin(angle);
  const Vec3 u = frame.tangent * cosine + frame.bitangent * sine;
  const Vec3 v = frame.bitangent * cosine - frame.tangent * sine;
  const auto rays = static_cast<float>(turns_.size());
  std::uint32_t open = 0;
  for (std::size_t i = 0; i < turns_.size(); ++i) {
    const float squared = (static_cast<float>(i) + shift) / rays, radius = std::sqrt(squared);
    const Vec3 direction = normalize(u * (radius * turns_[i].x) + v * (radius * turns_[i].y) +
                                     frame.normal * std::sqrt(1 - squared));
    if (!scene.occluded(origin, direction, distance_)) ++open;
  }
  return static_cast<float>(open) / rays;
}

}  // namespace gicodec::ao
