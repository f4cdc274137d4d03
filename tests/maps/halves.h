// A room in two halves, and what a client holds of its map.
#pragma once

#include "../ddgi/rooms.h"

#include "maps/maps.h"

#include <string>
#include <vector>

namespace gicodec::maps::test {

/// A room of 12 × 6 × 8 metres, which a wall parts at x = 0, lamps in one half of it, where a ball
/// moves.
inline ddgi::Scene halves() {
  ddgi::Scene s = ddgi::test::room({6, 3, 4}, 0.6F, 0, 3);
  ddgi::MeshBuilder wall(0), ball(0);
  wall.box({-0.2F, -3.2F, -4.2F}, {0.2F, 3.2F, 4.2F}, false, 3);
  ball.sphere({}, 0.8F, 12);
  s.objects[0].meshes.push_back(s.add_mesh(wall.take()));
  const std::uint32_t moving = s.add_object({.name = "ball",
                                             .meshes = {s.add_mesh(ball.take())},
                                             .transform = ddgi::translation({3, 0, 0}),
                                             .dynamic = true});
  s.lights.push_back({.type = ddgi::LightType::point, .colour = {5, 4, 3}, .position = {4, 2, 1}});
  s.animate = [moving](double time, ddgi::FrameState& state) {
    state.transforms[moving] = ddgi::translation({3, static_cast<float>(time) - 1, 0});
    state.lights[0].position.x = 4 + static_cast<float>(time) * 0.3F;
  };
  return s;
}

inline MapOptions options(const std::vector<std::string>& given) {
  std::vector<std::string> all{"size=64", "bases=300", "rays=16", "warmup=1"};
  all.insert(all.end(), given.begin(), given.end());
  return options_of({kTracedMaps.name, kTracedMaps.settings, all}, 1);
}

/// A volume as a client holds it.
struct Held {
  VolumeDesc desc;
  VolumeGeometry geometry{};
  std::vector<std::vector<std::byte>> texels;
  std::vector<std::vector<std::uint8_t>> received{};  ///< by texture; empty: all

  explicit Held(const MapServer& server)
      : desc(*irradiance_map_volume(server.desc())), texels(server.textures()) {}

  void forget_all() {
    for (const NamedTexture* texture : textures_of(desc)) {
      received.emplace_back(block_count(texture->desc), std::uint8_t{0});
    }
  }
  void show(MapLight& light, double time) const {
    light.update({desc, geometry, kinds::held_of(desc, texels, received)}, time);
  }
};

}  // namespace gicodec::maps::test
