// gi-trace: traces the probe volume of a scene and writes it as dumps, frame by frame; other kinds
// of payload as a container.
#include "ddgi_volume.h"
#include "dump_folder.h"
#include "engine_textures.h"
#include "first_hits.h"
#include "framing.h"
#include "gltf.h"
#include "kinds/kind_trace.h"
#include "maps/maps.h"
#include "program.h"
#include "progress.h"
#include "scene_source.h"
#include "scenes.h"
#include "trace_flags.h"
#include "trace_output.h"

#include "dump/file.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <optional>

namespace {

using namespace gicodec;
using namespace gicodec::ddgi;
using tools::Exit;
using Options = TraceFlags;

Exit list_scenes() {
  for (const SceneInfo& info : built_in_scenes()) {
    tools::print("{:8} {:10} {:7} triangles  {}\n", info.name, tools::to_string(info.grid),
                 info.triangles, info.summary);
  }
  return Exit::ok;
}

/// One line per frame: the eye and what is seen from it.
std::string view_line(std::uint32_t frame, const RayScene& scene, Vec3 eye, std::uint32_t samples) {
  nlohmann::ordered_json hits = nlohmann::ordered_json::array();
  for (const FirstHit& hit : first_hits(scene, eye, samples)) {
    hits.push_back({hit.position.x, hit.position.y, hit.position.z});
  }
  const nlohmann::ordered_json line{
      {"frame", frame}, {"eye", {eye.x, eye.y, eye.z}}, {"hits", hits}};
  return line.dump() + "\n";
}

/// What the folder holds after a trace that did not come to its end, and how to go on.
void print_unfinished(const Options& o, const DumpFolder& folder, std::uint32_t frames) {
  std::string text;
  if (folder.replaces()) {
    text = fmt::format("{} is as it was; trace again to replace what it holds", o.output);
  } else if (frames == 0) {
    text = "no frame was finished";
  } else {
    text = fmt::format("{} holds {} of {} frames, whole; ", o.output, frames, o.frames);
    text += o.trace.mode == TraceMode::converged
                ? "the same command with --resume traces the others"
                : "noisy frames build on each other, so --overwrite traces them anew";
  }
  tools::print(stderr, "gi-trace: not finished: {}\n", text);
}

/// Says why the textures are black, if they are.
void print_black(const Scene& scene, const DdgiVolume& volume, bool any_light) {
  if (any_light) return;
  if (!volume.active_probes().empty()) {
    tools::print(stderr,
                 "gi-trace: the colour of all frames is black: no light reaches a probe; --start "
                 "chooses another time, --bounds another place\n");
    return;
  }
  const Box box = outer_box(scene.bounds());
  tools::print(stderr,
               "gi-trace: all {} probes stand inside of solids, so all frames are black; "
               "--bounds={:g},{:g},{:g},{:g},{:g},{:g} reaches around the scene\n",
               volume.shape().probes(), box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z);
}

struct Summary {
  std::uint64_t rays = 0;
  std::uint32_t updates = 0, bounces = 0;
  double seconds = 0;
  bool any_light = false;
};

/// Traces all frames that the folder lacks.
Summary trace_frames(const Options& o, const Scene& scene, RayScene& rays, DdgiVolume& volume,
                     DumpFolder& folder, TraceOutput& output) {
  Summary sum;
  std::vector<DumpFolder::CameraFrame> cameras;
  std::string views;
  std::uint32_t done = 0;
  for (std::uint32_t frame = 0; frame < o.frames; ++frame) done += folder.holds(frame) ? 1 : 0;
  try {
    const std::uint32_t warmup = o.trace.mode == TraceMode::noisy ? o.warmup : 0;
    TraceProgress progress(o.frames - done + warmup, o.quiet);
    const auto update = [&](double time) {
      check_interrupt();
      const UpdateStatistics one = volume.update(time);
      progress.step(one);
      sum.rays += one.probe_rays + one.shadow_rays;
      sum.bounces = std::max(sum.bounces, one.bounces);
      sum.seconds += one.seconds;
      ++sum.updates;
    };
    for (std::uint32_t i = 0; i < warmup; ++i) update(o.start);
    for (std::uint32_t frame = 0; frame < o.frames; ++frame) {
      const double time = o.start + frame / o.fps;
      cameras.push_back({frame, time, scene.camera_at(time)});
      if (folder.holds(frame)) {
        sum.any_light = true;  // or it was said when they were traced
        rays.set_state(scene.state_at(time));
        volume.skip();
      } else {
        update(time);
        output.write(frame, time);
        ++done;
        sum.any_light = sum.any_light || any_light(volume.textures());
      }
      if (o.view_samples > 0)
        views += view_line(frame, rays, cameras.back().camera.eye, o.view_samples);
    }
    folder.write_cameras(cameras);
    output.finish();
    if (o.view_samples > 0) folder.write_views(views);
  } catch (...) {
    print_unfinished(o, folder, output.writes_frames() ? done : 0);
    throw;
  }
  return sum;
}

/// The scene with the coordinates of its irradiance map as TEXCOORD_1.
void export_map(const Options& o, const kinds::TracedKind& kind, const tools::InputFiles& inputs) {
  if (&kind != kinds::find_traced_kind("irradiance_maps"))
    tools::fail(Exit::usage, "--export-gltf is for probes and irradiance_maps");
  const tools::Existing existing = tools::overwrite_if(o.overwrite);
  check_output(o.export_gltf, inputs, existing);
  const kinds::Settings settings(kind.name, kind.settings, o.kind.set);
  const Scene scene = load_scene(o.scene);
  const std::uint32_t size = settings.whole("size", 16, maps::kMaxTracedSide);
  save_gltf(o.export_gltf, scene, o.start, o.frames, o.fps, existing,
            maps::second_uvs(scene, size));
}

/// Another kind than probes, into a container.
Exit trace_other(const Options& o, const kinds::TracedKind& kind) {
  if (o.output.empty() && o.export_gltf.empty())
    tools::fail(Exit::usage, "-o FILE.gic is needed for --kind {}", kind.name);
  const tools::InputFiles inputs({o.scene.gltf});
  if (!o.export_gltf.empty()) export_map(o, kind, inputs);
  if (o.output.empty()) return Exit::ok;
  check_output(o.output, inputs,
               o.overwrite ? tools::Existing::container : tools::Existing::refuse);
  return kinds::write_trace({.kind = kind,
                             .flags = o.kind,
                             .scene = o.scene,
                             .output = o.output,
                             .times = {o.start, o.fps},
                             .frames = o.frames,
                             .seed = o.trace.seed,
                             .threads = o.threads,
                             .quiet = o.quiet});
}

Exit trace(const Options& o) {
  if (o.output.empty() && o.export_gltf.empty())
    tools::fail(Exit::usage, "-o DIR is needed, or --export-gltf FILE");
  if (o.resume && o.trace.mode == TraceMode::noisy)
    tools::fail(Exit::usage,
                "--resume is for --mode converged: noisy frames build on each other; "
                "--overwrite traces them anew");
  if (o.resume && o.files == "gic")
    tools::fail(Exit::usage,
                "--resume is not for {}, whose frames are all in one file; --overwrite traces them "
                "anew",
                usual_files(o) == o.files ? "--layout " + o.layout : "--files gic");
  Scene scene = load_scene(o.scene);
  const tools::InputFiles inputs(scene.files);
  place_volume(o.scene, scene);
  std::optional<EngineTextures> engine;
  if (o.engine != nullptr) {
    scene.grid = probes_of(*o.engine, scene.grid);
    engine.emplace(*o.engine, scene.grid);
  }
  EngineTextures* const layout = engine ? &*engine : nullptr;
  if (!o.export_gltf.empty()) {
    const tools::Existing existing = tools::overwrite_if(o.overwrite);
    check_output(o.export_gltf, inputs, existing);
    save_gltf(o.export_gltf, scene, o.start, o.frames, o.fps, existing);
    if (o.output.empty()) return Exit::ok;
  }
  const VolumeShape shape = spread(scene.grid, scene.volume);
  const FrameFiles files = files_of(o, layout);
  DumpFolder folder(o.output, scene_label(o.scene), shape, settings(o, shape),
                    o.overwrite ? Former::replace
                    : o.resume  ? Former::resume
                                : Former::refuse,
                    inputs, files);
  ThreadPool pool(o.threads);
  RayScene rays(scene);
  DdgiVolume volume(rays, shape, o.trace, pool);
  const bool probes = o.engine == nullptr || o.engine->unit == GridUnit::probe;
  folder.write_positions(volume.active_probes(), probes);
  TraceOutput output(o, volume, layout, folder);
  const Summary sum = trace_frames(o, scene, rays, volume, folder, output);
  folder.finish();
  print_black(scene, volume, sum.any_light);
  if (o.quiet || sum.updates == 0) return Exit::ok;
  const auto active = volume.active_probes().size();
  tools::print(
      stderr,
      "gi-trace: {}: {} frame{} of {} probes, {} active ({:.1f} %), {} triangles, up to {} "
      "bounce{}; {:.3f} s per update, {:.2f} Mrays/s on {} thread{}\n",
      o.output, o.frames, o.frames == 1 ? "" : "s", tools::to_string(shape.grid), active,
      100.0 * static_cast<double>(active) / shape.probes(), scene.triangle_count(), sum.bounces,
      sum.bounces == 1 ? "" : "s", sum.seconds / sum.updates,
      static_cast<double>(sum.rays) / sum.seconds * 1e-6, pool.threads(),
      pool.threads() == 1 ? "" : "s");
  if (o.engine != nullptr && o.files != "gic") {
    tools::print(stderr, "gi-trace: gicodec encode takes these files by --layout {} --grid {}\n",
                 o.layout, tools::to_string(layout_grid(*o.engine, shape.grid)));
  }
  if (o.trace.mode == TraceMode::converged && sum.bounces >= o.trace.max_bounces) {
    tools::print(stderr, "gi-trace: light still bounced after {} bounces\n", o.trace.max_bounces);
  }
  return Exit::ok;
}

}  // namespace

int main(int argc, char** argv) {
  tools::Command app{
      "Traces the light of a scene: probes (DDGI) as dumps, other kinds as a container.",
      "gi-trace"};
  Options options;
  add_flags(app, options);
  app.footer(
      "Writes DIR/color.FFFF.exr, DIR/vis.FFFF.exr (others with --layout and --files),\n"
      "positions.csv, inactive.txt (of layouts of probes), camera.json and trace.json; of other "
      "kinds\n"
      "than probes one container.\n\n" +
      kinds::settings_help() +
      "Exit codes: 0 success, 2 wrong usage, 3 damaged or unsuitable input, 4 a file cannot be\n"
      "opened, read or written, 5 an internal error. Interrupted, it ends by the signal: 130, "
      "143.\n\n"
      "Examples:\n"
      "  gi-trace --scene tomb --frames 64 -o dumps/tomb\n"
      "  gi-trace --scene villa --grid 16x8x8 --mode noisy -o dumps/villa\n"
      "  gi-trace --gltf room.glb --grid 16x8x16 -o dumps/room\n"
      "  gi-trace --scene tomb --vk-format color=R16G16B16A16_SFLOAT --sh l1 -o dumps/half\n"
      "  gi-trace --scene villa --layout rtxgi --files dds -o dumps/rtxgi\n"
      "  gi-trace --scene street --frames 100 --export-gltf street.glb\n"
      "  gi-trace --scene tomb --kind photons --frames 20 -o photons.gic\n");
  return run_program(app, argc, argv, [&] {
    if (options.list) return list_scenes();
    if (const kinds::TracedKind* kind = traced_kind(options.kind)) {
      check_kind(app, options);
      return trace_other(options, *kind);
    }
    resolve(options);
    return trace(options);
  });
}
