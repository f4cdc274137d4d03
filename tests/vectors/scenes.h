// Scenes with known answers.
#pragma once

#include "../ddgi/rooms.h"

namespace gicodec::vectors::test {

/// Nothing but a sky of one radiance, and a floor far below which nobody sees, or 0.01 m below the
/// lowest vertices, which reflects nothing.
inline ddgi::Scene under_sky(float radiance, bool floor) {
  ddgi::Scene s;
  s.name = "sky";
  const ddgi::Vec3 all{radiance, radiance * 0.5F, radiance * 2};
  s.sky = {.zenith = all, .horizon = all, .ground = all};
  const std::uint32_t black = s.add_material({.name = "black", .colour = {}});
  ddgi::MeshBuilder ground(black);
  if (floor) {
    ground.patch({-1000, -1.01F, -1000}, {0, 0, 2000}, {2000, 0, 0});
  } else {
    ground.patch({-1, -1000, -1}, {0, 0, 0.01F}, {0.01F, 0, 0});
  }
  s.add_object({.name = "ground", .meshes = {s.add_mesh(ground.take())}});
  s.volume = {{-1, -1, -1}, {1, 1, 1}};
  s.grid = {2, 2, 2};
  return s;
}

}  // namespace gicodec::vectors::test
