#include "scene_flags.h"

#include "ddgi/gltf.h"
#include "ddgi/scenes.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/text.h"
#include "kinds/settings.h"

#include <gicodec/probes.h>

#include <filesystem>

namespace gicodec::kinds {

using ddgi::Box;
using ddgi::Scene;
using ddgi::SceneInfo;
using ddgi::VolumeShape;
using tools::Exit;
using tools::fail;

void add_scene_flags(tools::Command& app, SceneFlags& flags) {
  std::string names;
  for (const SceneInfo& info : ddgi::built_in_scenes()) {
    names += fmt::format("{}{}", names.empty() ? "" : ", ", info.name);
  }
  auto* scene =
      app.add_option("--scene", flags.scene, "Built-in scene: " + names)->type_name("NAME");
  auto* gltf = app.add_option("--gltf", flags.gltf, "Scene from a glTF 2.0 file, .gltf or .glb")
                   ->type_name("FILE");
  scene->excludes(gltf);
  app.add_flag("--allow-outside", flags.outside,
               "The glTF file may name buffers and images outside of its folder");
  app.add_option(
         "--grid", flags.grid,
         "Probes in x, y and z; default: the scene's own, for glTF that of its extras or 16x8x16")
      ->type_name("NXxNYxNZ");
  app.add_option(
         "--bounds", flags.bounds,
         "Where the first and the last probe stand; default: the scene's own, for glTF that of its "
         "extras or the scene's bounds shrunk by 2 %")
      ->type_name("X0,Y0,Z0,X1,Y1,Z1");
}

Scene load_scene(const SceneFlags& flags) {
  if (!flags.gltf.empty()) return ddgi::load_gltf(flags.gltf, flags.outside);
  if (flags.scene.empty())
    fail(Exit::usage, "--scene or --gltf is needed; --help lists the scenes");
  if (auto scene = ddgi::make_scene(flags.scene)) return *std::move(scene);
  std::string names;
  for (const SceneInfo& info : ddgi::built_in_scenes()) names += fmt::format(" {}", info.name);
  fail(Exit::usage, "unknown scene {}; there are:{}", flags.scene, names);
}

std::string scene_label(const SceneFlags& flags) {
  if (flags.gltf.empty()) return flags.scene;
  return tools::utf8_text(std::filesystem::path(flags.gltf).filename().string());
}

std::vector<float> numbers(const std::string& text, std::size_t count, const char* what) {
  auto values = numbers_from_string(text, count);
  if (values.empty())
    fail(Exit::usage, "{}: expected {} numbers with commas between, not \"{}\"", what, count, text);
  return values;
}

namespace {

struct Placing {
  Grid grid;
  Box box;
};

Placing placing(const SceneFlags& flags, const Scene& scene) {
  Grid grid = scene.grid;
  if (!flags.grid.empty()) {
    const auto parsed = tools::grid_from_string(flags.grid);
    if (!parsed)
      fail(Exit::usage, "--grid: expected a grid such as 16x8x16, not \"{}\"", flags.grid);
    grid = *parsed;
  }
  if (validate(ddgi_irradiance(grid)) != Status::ok ||
      std::uint64_t{grid.x} * grid.y * grid.z > ddgi::kMaxProbes) {
    fail(Exit::usage, "--grid: 1 to {} probes can be traced, not {}", ddgi::kMaxProbes,
         tools::to_string(grid));
  }
  Box box = scene.volume;
  if (!flags.bounds.empty()) {
    const auto n = numbers(flags.bounds, 6, "--bounds");
    box = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    if (box.lo.x >= box.hi.x || box.lo.y >= box.hi.y || box.lo.z >= box.hi.z) {
      fail(Exit::usage, "--bounds: the second corner must lie beyond the first, not \"{}\"",
           flags.bounds);
    }
  }
  return {grid, box};
}

}  // namespace

void place_volume(const SceneFlags& flags, Scene& scene) {
  const Placing p = placing(flags, scene);
  scene.grid = p.grid;
  scene.volume = p.box;
}

VolumeShape volume_of(const SceneFlags& flags, const Scene& scene) {
  const Placing p = placing(flags, scene);
  return ddgi::spread(p.grid, p.box);
}

ddgi::RenderOptions picture_options(const std::string& size, std::uint32_t samples,
                                    const char* example) {
  const auto sides = tools::grid_from_string(size + "x1");
  if (!sides || sides->x < 1 || sides->y < 1 || sides->x > 16384 || sides->y > 16384) {
    tools::fail(Exit::usage, "--size: expected a size such as {}, at most 16384x16384, not \"{}\"",
                example, size);
  }
  ddgi::RenderOptions options;
  options.width = sides->x;
  options.height = sides->y;
  options.samples = samples;
  return options;
}

}  // namespace gicodec::kinds
