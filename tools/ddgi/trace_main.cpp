// gi-trace: traces the light of a scene, of any kind, and writes it as a container.
#include "gltf.h"
#include "kinds/kind_trace.h"
#include "maps/maps.h"
#include "program.h"
#include "scene_source.h"
#include "scenes.h"

#include "dump/dump.h"
#include "dump/file.h"

#include <array>
#include <utility>

namespace {

using namespace gicodec;
using namespace gicodec::ddgi;
using tools::Exit;

struct Options {
  SceneFlags scene;
  kinds::KindFlags kind;
  std::string output, export_gltf;
  std::uint32_t frames = 64, seed = 1;
  double start = 0, fps = 10;
  unsigned threads = 0;
  bool quiet = false, overwrite = false, list = false;
};

void add_flags(tools::Command& app, Options& o) {
  add_scene_flags(app, o.scene);
  kinds::add_kind_flags(app, o.kind);
  app.add_option("-o,--output", o.output, "Container to write; - for standard output")
      ->type_name("FILE.gic");
  app.add_option("--frames", o.frames, "Frames to trace")
      ->allow(tools::in_range(1, 1000000))
      ->show_default();
  app.add_option("--fps", o.fps, "Frames per second of the scene's time")
      ->allow(tools::in_range(0.001, 1e6))
      ->show_default();
  app.add_option("--start", o.start, "Time of frame 0 in seconds")
      ->allow(tools::in_range(0.0, 1e6))
      ->show_default();
  app.add_option("--seed", o.seed, "Of all that is random")->show_default();
  app.add_option("--export-gltf", o.export_gltf,
                 "Write the scene as .glb, with --frames of its motion")
      ->type_name("FILE");
  app.add_flag("--list-scenes", o.list, "List the built-in scenes");
  app.add_flag("--overwrite", o.overwrite,
               "Replace a container when all is traced, and the file of --export-gltf");
  app.add_option("--threads", o.threads, "Threads to use; default: one per processor")
      ->allow(tools::in_range(1, 256));
  app.add_flag("-q,--quiet", o.quiet, "No progress, no remarks and no summary");
}

Exit list_scenes() {
  for (const SceneInfo& info : built_in_scenes()) {
    tools::print("{:8} {:10} {:7} triangles  {}\n", info.name, tools::to_string(info.grid),
                 info.triangles, info.summary);
  }
  return Exit::ok;
}

/// The scene as it is, or with the coordinates of its irradiance map as TEXCOORD_1.
void export_scene(const Options& o, const Scene& scene, const tools::InputFiles& inputs) {
  const kinds::TracedKind& kind = traced_kind(o.kind);
  const bool map = kind.name == "irradiance_maps";
  if (!map && kind.name != "probes")
    tools::fail(Exit::usage, "--export-gltf is for probes and irradiance_maps");
  const tools::Existing existing = tools::overwrite_if(o.overwrite);
  check_output(o.export_gltf, inputs, existing);
  if (!map) {
    save_gltf(o.export_gltf, scene, o.start, o.frames, o.fps, existing);
    return;
  }
  const std::uint32_t size = settings_of(kind, o.kind).whole("size", 16, maps::kMaxTracedSide);
  save_gltf(o.export_gltf, scene, o.start, o.frames, o.fps, existing,
            maps::second_uvs(scene, size));
}

Exit trace(const Options& o) {
  if (o.output.empty() && o.export_gltf.empty())
    tools::fail(Exit::usage, "-o FILE.gic is needed, or --export-gltf FILE");
  Scene scene = load_scene(o.scene);
  place_volume(o.scene, scene);
  const tools::InputFiles inputs(scene.files);
  if (!o.export_gltf.empty()) export_scene(o, scene, inputs);
  if (o.output.empty()) return Exit::ok;
  check_output(o.output, inputs,
               o.overwrite ? tools::Existing::container : tools::Existing::refuse);
  return kinds::write_trace({.flags = o.kind,
                             .scene = std::move(scene),
                             .label = scene_label(o.scene),
                             .output = o.output,
                             .times = {o.start, o.fps},
                             .frames = o.frames,
                             .seed = o.seed,
                             .threads = o.threads,
                             .quiet = o.quiet});
}

}  // namespace

int main(int argc, char** argv) {
  tools::Command app{"Traces the light of a scene into a container.", "gi-trace"};
  Options options;
  add_flags(app, options);
  app.footer(
      "gicodec decode makes dumps of the container, EXR, DDS, KTX2 or raw.\n\n" +
      kinds::settings_help() +
      "Exit codes:\n"
      "  0  success\n"
      "  2  the command line makes no sense, such as an unknown scene\n"
      "  3  the glTF file is damaged, too large or uses what is not supported\n"
      "  4  a file cannot be opened, read or written, or is there already\n"
      "  5  an internal error, or memory ran out\n"
      "Interrupted, it ends by the signal once the frame is written: 130, 143, 129.\n\n"
      "Examples:\n"
      "  gi-trace --scene tomb --frames 64 -o tomb.gic\n"
      "  gi-trace --scene villa --grid 16x8x8 --mode noisy -o villa.gic\n"
      "  gi-trace --gltf room.glb --grid 16x8x16 -o room.gic\n"
      "  gi-trace --scene tomb --vk-format color=R16G16B16A16_SFLOAT --sh l1 -o half.gic\n"
      "  gi-trace --scene villa --layout rtxgi -o rtxgi.gic && gicodec decode rtxgi.gic -o dumps/ "
      "--files dds\n"
      "  gi-trace --scene street --frames 100 --export-gltf street.glb\n"
      "  gi-trace --scene tomb --kind photons --frames 20 -o photons.gic\n");
  return run_program(app, argc, argv, [&] {
    if (options.list) return list_scenes();
    constexpr std::array kOfProbes{"--grid", "--bounds"};
    kinds::refuse_flags_of_probes(app, options.kind, kOfProbes);
    return trace(options);
  });
}
