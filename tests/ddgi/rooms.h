// Small scenes with known answers.
#pragma once

#include "ddgi/ddgi_volume.h"
#include "ddgi/shapes.h"

#include <string>

namespace gicodec::ddgi::test {

/// A closed room of a size, seen from inside, all of one albedo and emission.
inline Scene room(Vec3 half, float albedo, float emission, std::uint32_t cells = 1) {
  Scene s;
  s.name = "room";
  const std::uint32_t wall = s.add_material({.name = "wall",
                                             .colour = {albedo, albedo, albedo},
                                             .emission = {emission, emission, emission}});
  MeshBuilder walls(wall);
  walls.box(-half, half, true, cells);
  s.add_object({.name = "room", .meshes = {s.add_mesh(walls.take())}});
  s.volume = {half * -0.9F, half * 0.9F};
  s.grid = {4, 3, 5};
  return s;
}

/// A room with a ball that moves, a point light and a solid block.
inline Scene busy_room() {
  Scene s = room({6, 3, 8}, 0.6F, 0);
  const std::uint32_t red = s.add_material({.name = "red", .colour = {0.7F, 0.2F, 0.1F}});
  MeshBuilder block(red), ball(red);
  block.box({-5.5F, -2.9F, -7.5F}, {-2, 2.9F, -3});
  ball.sphere({}, 0.8F, 24);
  s.objects[0].meshes.push_back(s.add_mesh(block.take()));
  const std::uint32_t moving =
      s.add_object({.name = "ball", .meshes = {s.add_mesh(ball.take())}, .dynamic = true});
  s.lights.push_back({.type = LightType::point, .colour = {8, 7, 5}, .position = {1, 2, 1}});
  s.animate = [moving](double time, FrameState& state) {
    state.transforms[moving] = translation({static_cast<float>(time) - 2, -1, 3});
  };
  return s;
}

/// Scene, rays and volume with their threads.
struct Traced {
  Scene scene;
  ThreadPool pool;
  RayScene rays;
  DdgiVolume volume;

  Traced(Scene scene_in, const TraceOptions& options, unsigned threads = 2)
      : scene(std::move(scene_in)),
        pool(threads),
        rays(scene),
        volume(rays, spread(scene.grid, scene.volume), options, pool) {}
};

/// Calls visit(probe, x, y, what is stored of R, G, B: codes or floats) for each core texel of the
/// probes.
template <typename Visit>
void for_core_texels(const ProbeTextures& textures, std::span<const std::uint32_t> probes,
                     Visit visit) {
  const TextureDesc& desc = textures.color_desc;
  const ColorTexels format(desc.record.format, textures.encoding);
  std::vector<std::byte> block(bytes_of_block(desc));
  for (const std::uint32_t probe : probes) {
    read_block(desc, textures.color, probe, block);
    for (std::uint32_t t = 0; t < record_count(desc.block); ++t) {
      const Vec3 c = format.load(core_texel(desc, block, t));
      visit(probe, t % desc.block.x, t / desc.block.x, c.x, c.y, c.z);
    }
  }
}

}  // namespace gicodec::ddgi::test
