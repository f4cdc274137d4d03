// How much of the hemisphere above a place is open, by rays.
#pragma once

#include "ddgi/ray_scene.h"

#include <cstdint>
#include <vector>

namespace gicodec::ao {

struct Frame {
  ddgi::Vec3 tangent, bitangent, normal;  ///< unit length
};
[[nodiscard]] Frame frame_around(ddgi::Vec3 normal);

/// A fixed number of rays, distributed as the cosine to the normal.
class Hemisphere {
 public:
  /// Preconditions: at least one ray, a positive distance in metres.
  Hemisphere(std::uint32_t rays, float distance);

  /// The share of them that meets nothing within the distance. `place` is on a surface whose
  /// triangle has the normal `geometric`; `seed` turns the pattern and moves its rings.
  [[nodiscard]] float visible(const ddgi::RayScene& scene, ddgi::Vec3 place, ddgi::Vec3 geometric,
                              const Frame& frame, std::uint32_t seed) const;

 private:
  std::vector<ddgi::Vec2> turns_;  ///< of each ray around the normal: cosine, sine
  float distance_;
};

}  // namespace gicodec::ao
