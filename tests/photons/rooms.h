// Small scenes of which all light is known.
#pragma once

#include "../ddgi/rooms.h"

#include "photons/photons.h"

namespace gicodec::photons::test {

using ddgi::Light;
using ddgi::LightType;
using ddgi::Scene;
using ddgi::Vec3;

inline constexpr float kAlbedo = 0.5F;

/// A closed room of 8 × 4 × 6 metres with a lamp of 4π watts.
inline Scene lit_room() {
  Scene s = ddgi::test::room({4, 2, 3}, kAlbedo, 0);
  s.lights.push_back({.type = LightType::point, .colour = {1.5F, 1, 0.5F}, .position = {1, 0, 0}});
  return s;
}

/// The room with a lamp at each end, one of which fades, turns red and moves in time, and a ball
/// that moves behind a wall, where the light of the other one does not get.
inline Scene two_lights() {
  Scene s = lit_room();
  ddgi::MeshBuilder wall(0), ball(0);
  wall.box({-1.1F, -2.1F, -3.1F}, {-0.9F, 2.1F, 3.1F});
  s.objects[0].meshes.push_back(s.add_mesh(wall.take()));
  ball.sphere({}, 0.3F, 8);
  const std::uint32_t moving =
      s.add_object({.name = "ball", .meshes = {s.add_mesh(ball.take())}, .dynamic = true});
  s.lights[0].position = {2, 0, 0};
  s.lights.push_back({.type = LightType::point, .colour = {1, 1, 1}, .position = {-2, 0, 0}});
  s.animate = [moving](double time, ddgi::FrameState& state) {
    state.transforms[moving] = ddgi::translation({3, -1, 1});
    if (time == 1) state.lights[0].colour *= 0.5F;
    if (time == 2) state.lights[0].colour = {2, 0.5F, 0.5F};
    if (time == 3) state.lights[0].position = {2, 0.5F, 0};
    if (time == 4) state.transforms[moving] = ddgi::translation({2, -1, 1});
    if (time == 5) state.lights[0].colour = {};
  };
  return s;
}

inline kinds::Settings settings(const std::vector<std::string>& given) {
  return {"photons", kTracedPhotons.settings, given};
}

/// A volume's textures as a client holds them.
struct Held {
  kinds::FeedVolume volume;
  std::vector<std::vector<std::byte>> texels;
  std::vector<std::vector<std::uint8_t>> received = {};  ///< by texture; empty: all

  explicit Held(kinds::FeedVolume volume_in) : volume(std::move(volume_in)) {
    for (const NamedTexture* texture : textures_of(volume.desc)) {
      texels.emplace_back(static_cast<std::size_t>(texture_bytes(texture->desc)));
    }
  }
  void give(kinds::VolumeLight& light) const {
    light.update({volume.desc, volume.geometry, kinds::held_of(volume.desc, texels, received)}, 0);
  }
};

}  // namespace gicodec::photons::test
