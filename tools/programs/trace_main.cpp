// gi-trace: traces the light of a scene, of any kind, and writes it as a container.
#include "feed_container.h"
#include "kind_flags.h"

#include "common/program.h"
#include "ddgi/gltf.h"
#include "ddgi/scenes.h"
#include "dump/dump.h"
#include "dump/file.h"
#include "maps/maps.h"

#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <utility>

namespace {

using namespace gicodec;
using namespace gicodec::kinds;
using ddgi::Scene;
using tools::Exit;

struct Options {
  SceneFlags scene;
  KindFlags kind;
  std::string output, export_gltf;
  std::uint32_t frames = 64, seed = 1;
  double start = 0, fps = 10;
  unsigned threads = 0;
  bool quiet = false, overwrite = false, list = false;
};

void add_flags(tools::Command& app, Options& o) {
  add_scene_flags(app, o.scene);
  add_kind_flags(app, o.kind);
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
  for (const ddgi::SceneInfo& info : ddgi::built_in_scenes()) {
    tools::print("{:8} {:10} {:7} triangles  {}\n", info.name, tools::to_string(info.grid),
                 info.triangles, info.summary);
  }
  return Exit::ok;
}

/// What the container may replace, at the start and when all is traced.
tools::Existing replaceable(const Options& o) {
  return o.overwrite ? tools::Existing::container : tools::Existing::refuse;
}

/// Writes the scene as glTF, for irradiance maps with their coordinates as TEXCOORD_1.
void export_scene(const Options& o, const Scene& scene, const tools::InputFiles& inputs) {
  const TracedKind& kind = traced_kind(o.kind);
  const bool map = kind.name == "irradiance_maps";
  if (!map && kind.name != "probes")
    tools::fail(Exit::usage, "--export-gltf is for probes and irradiance_maps");
  const tools::Existing existing = tools::overwrite_if(o.overwrite);
  check_output(o.export_gltf, inputs, existing);
  if (!map) {
    ddgi::save_gltf(o.export_gltf, scene, o.start, o.frames, o.fps, existing);
    return;
  }
  const std::uint32_t size = settings_of(kind, o.kind).whole("size", 16, maps::kMaxTracedSide);
  ddgi::save_gltf(o.export_gltf, scene, o.start, o.frames, o.fps, existing,
                  maps::second_uvs(scene, size));
}

/// "frame 12 of 64, 2.3 Mrays/s, 41 s left" on a terminal.
class Progress {
 public:
  explicit Progress(const Options& o)
      : total_(o.frames), shown_(!o.quiet && isatty(STDERR_FILENO) != 0) {}
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void step(const FeedFrame& frame) {
    ++done_;
    rays_ += static_cast<double>(frame.rays);
    seconds_ += frame.seconds;
    if (!shown_) return;
    const double elapsed =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    const double left = elapsed / done_ * (total_ - done_);
    tools::print(stderr, "\r\033[Kframe {} of {}{}, {:.0f} s left", done_, total_, speed(), left);
    std::fflush(stderr);
  }
  void clear() {
    if (std::exchange(shown_, false) && done_ > 0) tools::print(stderr, "\r\033[K");
  }
  /// ", 2.30 Mrays/s", or empty if rays are not counted.
  [[nodiscard]] std::string speed() const {
    return rays_ > 0 ? fmt::format(", {:.2f} Mrays/s", rays_ / seconds_ * 1e-6) : "";
  }
  [[nodiscard]] double seconds() const { return seconds_; }  ///< of tracing

 private:
  std::uint32_t total_, done_ = 0;
  bool shown_;
  double rays_ = 0, seconds_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

template <typename Work>
auto unless_cancelled(const Work& work) {
  try {
    return work();
  } catch (const ddgi::Cancelled&) {
    tools::check_interrupt();
    throw;
  }
}

void print_remarks(const std::vector<std::string>& remarks, bool quiet) {
  if (quiet) return;
  for (const std::string& remark : remarks) tools::print(stderr, "gi-trace: {}\n", remark);
}

void print_sums(const Options& o, const FeedContainer& container, const Progress& progress) {
  std::uint64_t all = 0;
  std::string textures;
  for (const FeedContainer::Sum& sum : container.sums()) {
    all += sum.bytes;
    textures += fmt::format("{}{} {:.1f} kB", textures.empty() ? "" : ", ", sum.texture,
                            static_cast<double>(sum.bytes) * 1e-3);
  }
  tools::print(stderr, "gi-trace: {}: {} frame{} of {}, {:.1f} kB ({}); {:.3f} s per frame{}\n",
               o.output, o.frames, o.frames == 1 ? "" : "s", o.kind.kind,
               static_cast<double>(all) * 1e-3, textures, progress.seconds() / o.frames,
               progress.speed());
}

void write_trace(const Options& o, Scene scene) {
  const kinds::Feed feed = unless_cancelled([&] {
    return trace_kind(o.kind, std::move(scene), scene_label(o.scene), o.seed, o.threads);
  });
  print_remarks(feed.remarks, o.quiet);
  const FrameTimes times{o.start, o.fps};
  FeedContainer container(o.output, feed, times, "native", replaceable(o));
  std::uint32_t frame = 0;
  try {
    Progress progress(o);
    for (; frame < o.frames; ++frame) {
      tools::check_interrupt();
      const FeedFrame contents = unless_cancelled([&] { return feed.next({times.at(frame), {}}); });
      print_remarks(contents.remarks, o.quiet);
      container.add(frame, contents);
      progress.step(contents);
    }
    container.finish();
    progress.clear();
    if (!o.quiet) print_sums(o, container, progress);
  } catch (const tools::Interrupted&) {
    // A container that is to be replaced stays until all is traced.
    const bool replaces = o.overwrite && std::filesystem::exists(o.output);
    std::string kept = o.output;
    if (frame > 0 && replaces) kept = container.leave();
    if (frame > 0 && !replaces) container.finish();
    tools::print(stderr, "gi-trace: {}: interrupted; {}\n", o.output,
                 frame == 0  ? "no frame was finished"
                 : !replaces ? fmt::format("it holds {} of {} frames", frame, o.frames)
                             : fmt::format("it stays as it was, and {} holds {} of {} frames, for "
                                           "--allow-incomplete",
                                           kept, frame, o.frames));
    throw;
  } catch (const tools::Error& problem) {
    const std::string left = frame > 0 ? container.leave() : "";
    if (left.empty()) throw;
    tools::fail(problem.code(), "{}; {} holds {} of {} frames, for --allow-incomplete",
                problem.what(), left, frame, o.frames);
  }
}

Exit trace(const Options& o) {
  if (o.output.empty() && o.export_gltf.empty())
    tools::fail(Exit::usage, "-o FILE.gic is needed, or --export-gltf FILE");
  Scene scene = load_scene(o.scene);
  place_volume(o.scene, scene);
  const tools::InputFiles inputs(scene.files);
  if (!o.export_gltf.empty()) export_scene(o, scene, inputs);
  if (o.output.empty()) return Exit::ok;
  check_output(o.output, inputs, replaceable(o));
  write_trace(o, std::move(scene));
  return Exit::ok;
}

}  // namespace

int main(int argc, char** argv) {
  tools::Command app{"Traces the light of a scene into a container.", "gi-trace"};
  Options options;
  add_flags(app, options);
  app.footer(
      "gicodec decode makes dumps of the container, EXR, DDS, KTX2 or raw.\n\n" + settings_help() +
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
  return tools::run_program(app, argc, argv, [&] {
    if (options.list) return list_scenes();
    constexpr std::array kOfProbes{"--grid", "--bounds"};
    refuse_flags_of_probes(app, options.kind, kOfProbes);
    return trace(options);
  });
}
