// gi-render: the picture a thin client draws from decoded light.
#include "kind_flags.h"
#include "scene_flags.h"
#include "stored_volume.h"

#include "common/frame_range.h"
#include "common/program.h"
#include "ddgi/framing.h"
#include "ddgi/picture.h"
#include "ddgi/scene_id.h"
#include "ddgi/scenes.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/sequence.h"

#include <gicodec/gicodec.h>

#include <fmt/core.h>

#include <cstdio>

namespace {

using namespace gicodec;
using namespace gicodec::ddgi;
using namespace gicodec::kinds;
using tools::check_interrupt;
using tools::Exit;
using tools::fail;

struct Options {
  SceneFlags scene;
  std::string stream, dumps, output, mode = "full", camera, size = "960x540";
  std::uint64_t frame = 0;
  std::optional<double> time;
  std::optional<float> exposure;
  std::uint32_t samples = 2;
  float gain = 8;
  unsigned threads = 0;
  tools::DecoderFlags decoding;
  DrawingFlags drawing;
  bool compare = false, quiet = false, overwrite = false, allow_incomplete = false;
};

void add_flags(tools::Command& app, Options& o) {
  add_scene_flags(app, o.scene);
  app.add_option("--stream", o.stream,
                 "Container whose first volume of light is drawn; - for standard input")
      ->type_name("FILE");
  app.add_option("--dumps", o.dumps, "Folder with the probe textures as dumps")->type_name("DIR");
  app.add_option(
         "--frame", [&o](const std::string& text) { o.frame = tools::frame_from_string(text); },
         "Frame to draw; default: 0")
      ->type_name("N");
  app.add_option("-o,--output", o.output, "Picture to write, .png or .exr")->type_name("FILE");
  app.add_flag("--overwrite", o.overwrite, "Replace a picture that is there already");
  app.add_flag("--allow-incomplete", o.allow_incomplete,
               "Go on even if the container's end is missing");
  app.add_option("--mode", o.mode,
                 "full, direct light only, gi only (indirect light), or difference between the "
                 "pictures from --stream and --dumps")
      ->allow(tools::one_of({"full", "direct", "gi", "difference"}))
      ->show_default();
  app.add_flag("--compare", o.compare,
               "Draw from --stream and from --dumps and count the pixels that differ; exit code 1 "
               "if any does");
  app.add_option(
         "--camera", o.camera,
         "Eye and target, and the vertical angle of view in degrees; default: the scene's own")
      ->type_name("X,Y,Z,X,Y,Z[,DEGREES]");
  app.add_option("--exposure", o.exposure, "Factor before tone mapping; default: the camera's own")
      ->allow(tools::in_range(1e-6, 1e6));
  app.add_option("--time", o.time, "Time of the scene in seconds; default: the frame's own")
      ->allow(tools::in_range(0.0, 1e6));
  app.add_option("--size", o.size, "Size of the picture")->type_name("WxH")->show_default();
  app.add_option("--samples", o.samples, "Rays per pixel in each direction")
      ->allow(tools::in_range(1, 16))
      ->show_default();
  app.add_option("--gain", o.gain, "Factor on differences")
      ->allow(tools::in_range(1e-3, 1e6))
      ->show_default();
  app.add_option("--threads", o.threads, "Threads to use; default: one per processor")
      ->allow(tools::in_range(1, 256));
  tools::add_memory_flag(app, o.decoding, "; drawing may take as much again");
  tools::add_http_flags(app, o.decoding.http);
  add_drawing_flag(app, o.drawing);
  app.add_flag("-q,--quiet", o.quiet, "Nothing but errors");
}

/// Draws pictures of one scene at one time.
class Client {
 public:
  Client(const Options& options, Scene scene)
      : options_(options), scene_(std::move(scene)), pool_(options.threads), rays_(scene_) {}

  /// Places the scene at the time of `shown`, unless that is nullptr.
  void place(const StoredVolume* shown) {
    const Options& o = options_;
    const auto stored_time = shown == nullptr ? std::nullopt : shown->facts_at(o.frame).time;
    const double time = o.time.value_or(stored_time.value_or(static_cast<double>(o.frame) / 10));
    if (shown != nullptr && !stored_time && !o.time && !o.quiet) {
      tools::print(stderr, "gi-render: {}: does not say when; drawn as at {} s; --time sets it\n",
                   shown->path(), time);
    }
    rays_.set_state(scene_.state_at(time));
    camera_ = scene_.camera_at(time);
    if (!o.camera.empty()) {
      const auto commas = std::count(o.camera.begin(), o.camera.end(), ',');
      const auto n = numbers(o.camera, commas == 6 ? 7 : 6, "--camera");
      camera_.eye = {n[0], n[1], n[2]};
      camera_.target = {n[3], n[4], n[5]};
      camera_.up = {0, 1, 0};
      if (n.size() == 7) camera_.fov_y = std::clamp(n[6], 1.0F, 170.0F);
      if (length(cross(camera_.target - camera_.eye, camera_.up)) < 1e-6F) camera_.up = {0, 0, -1};
      if (camera_.eye == camera_.target)
        fail(Exit::usage, "--camera: eye and target are the same point; move one of them");
    }
    if (o.exposure) camera_.exposure = *o.exposure;
  }

  /// Draws with the light of `shown`; nullptr: with direct light only.
  [[nodiscard]] Picture draw(StoredVolume* shown, const RenderOptions& render_options) {
    std::unique_ptr<VolumeLight> light;
    if (shown != nullptr && render_options.mode != RenderMode::direct) {
      if (shown->kind().name == "probes") place_probes(*shown);
      light = make_light(shown->kind(), rays_, shown->desc(),
                         {options_.decoding.memory, options_.drawing.set});
      shown->show(options_.frame, *light);
    }
    Picture picture = render(rays_, light.get(), camera_, render_options, pool_);
    check_interrupt();
    return picture;
  }

  [[nodiscard]] float exposure() const { return camera_.exposure; }

  /// If a picture is black, prints the cause and a remedy.
  void explain(const std::string& path, const Picture& picture) const {
    const auto seen = [&](Vec3 p) {
      return std::max({p.x, p.y, p.z}) * camera_.exposure > 7e-4F;  // code 1 on the screen
    };
    if (std::any_of(picture.pixels.begin(), picture.pixels.end(), seen)) return;
    if (options_.mode == "gi") {
      tools::print(stderr,
                   "gi-render: {} is black: the probes bring no light to what the camera sees; "
                   "--mode full adds direct light\n",
                   path);
      return;
    }
    const auto view = find_view(rays_);
    const auto better = [](const Camera& c) {
      return fmt::format("--camera={:g},{:g},{:g},{:g},{:g},{:g}", c.eye.x, c.eye.y, c.eye.z,
                         c.target.x, c.target.y, c.target.z);
    };
    tools::print(stderr, "gi-render: {} is black: {}\n", path,
                 !view       ? "no surface can be seen from its front; turn the scene's triangles"
                 : view->lit ? "no light reaches what the camera sees; " + better(view->camera) +
                                   " sees lit surfaces, --exposure brightens"
                             : "no light reaches the scene's surfaces at this time; --time chooses "
                               "another, or give the scene lights");
  }

 private:
  /// Places probes by flags, files or the scene. They must be in the scene.
  void place_probes(StoredVolume& shown) const {
    const Grid grid = shown.desc().groups.front().textures.front().desc.grid;
    SceneFlags flags = options_.scene;
    if (!flags.grid.empty() && tools::grid_from_string(flags.grid) != grid) {
      fail(Exit::bad_input, "{}: its grid is {}, not {}; leave out --grid", shown.path(),
           tools::to_string(grid), flags.grid);
    }
    flags.grid = tools::to_string(grid);
    VolumeShape shape = volume_of(flags, scene_);
    const FrameFacts facts = shown.facts_at(options_.frame);
    if (flags.bounds.empty() && facts.origin && facts.spacing) {
      shape.origin = vec(*facts.origin);
      shape.spacing = vec(*facts.spacing);
    }
    const Box box = scene_.bounds();
    const Vec3 last = shape.position(shape.probes() - 1);
    const auto outside = [](float lo, float hi, float a, float b) { return hi < a || lo > b; };
    if (!(min(shape.spacing, {0, 0, 0}) == Vec3{0, 0, 0}) ||
        outside(shape.origin.x, last.x, box.lo.x, box.hi.x) ||
        outside(shape.origin.y, last.y, box.lo.y, box.hi.y) ||
        outside(shape.origin.z, last.z, box.lo.z, box.hi.z)) {
      fail(Exit::bad_input, "{}: its volume lies outside of {}; {}", shown.path(), scene_.name,
           flags.bounds.empty() ? "was it traced in another scene?" : "leave out --bounds");
    }
    shown.place(geometry_of(shape));
  }

  const Options& options_;
  Scene scene_;
  ThreadPool pool_;
  RayScene rays_;
  Camera camera_;
};

RenderOptions render_options(const Options& o) {
  RenderOptions r = picture_options(o.size, o.samples, "960x540");
  r.mode = o.mode == "direct" ? RenderMode::direct
           : o.mode == "gi"   ? RenderMode::gi
                              : RenderMode::full;
  r.stopped = tools::interrupted;
  return r;
}

void check_usage(const Options& o) {
  const bool both = !o.stream.empty() && !o.dumps.empty();
  const bool needs_both = o.compare || o.mode == "difference";
  if (needs_both && !both)
    fail(Exit::usage, "{} needs --stream and --dumps",
         o.compare ? "--compare" : "--mode difference");
  if (both && !needs_both)
    fail(Exit::usage, "--stream and --dumps together are for --compare and --mode difference");
  if (o.stream.empty() && o.dumps.empty() && o.mode != "direct")
    fail(Exit::usage, "--stream or --dumps is needed, or --mode direct, which reads no probes");
  if (o.output.empty() && !o.compare)
    fail(Exit::usage, "-o FILE is needed, .png or .exr; or --compare");
  if (!o.output.empty()) check_picture_name(o.output);
}

/// The scene of the flags, else that of `shown`. Fails if these differ.
Scene find_scene(const SceneFlags& flags, const StoredVolume* shown, const FrameFacts& facts) {
  SceneFlags used = flags;
  const bool scene_given = !flags.scene.empty() || !flags.gltf.empty();
  if (facts.scene && !(scene_given && *facts.scene == scene_label(flags))) {
    const bool built_in = is_built_in(*facts.scene);
    if (scene_given)
      fail(Exit::bad_input, "{}: was traced in {}, not in {}; {}", shown->path(), *facts.scene,
           scene_label(flags),
           built_in ? "leave out --scene and --gltf" : "name that file by --gltf FILE");
    if (!built_in)
      fail(Exit::usage,
           "{}: was traced in {}, which is no built-in scene; name that file by "
           "--gltf FILE",
           shown->path(), *facts.scene);
    used.scene = *facts.scene;
  } else if (shown != nullptr && !facts.scene && !scene_given) {
    fail(Exit::usage,
         "{}: does not say in which scene it was traced; --scene NAME or --gltf FILE "
         "is needed",
         shown->path());
  }
  Scene scene = load_scene(used);
  const std::uint64_t triangles = shown == nullptr ? 0 : shown->triangles();
  if (triangles != 0 && triangles != scene_id(scene_label(used), scene).geometry)
    fail(Exit::bad_input, "{}: was traced in a scene of other triangles than {}", shown->path(),
         scene.name);
  return scene;
}

/// Checks before any work that the picture would overwrite nothing that must stay.
void check_picture(const Options& o) {
  if (o.output.empty()) return;
  tools::InputFiles inputs({o.stream});
  if (!o.dumps.empty()) {
    for (const auto& sequence : tools::group_sequences({o.dumps}, {.allow_gaps = true})) {
      for (const auto& file : sequence.frames) inputs.add(file.path);
    }
  }
  check_output(o.output, inputs, tools::overwrite_if(o.overwrite));
}

Exit run(const Options& o) {
  check_usage(o);
  check_picture(o);
  const RenderOptions options = render_options(o);
  std::optional<StoredVolume> stream, dumps;
  if (!o.stream.empty()) stream.emplace(o.stream, o.allow_incomplete, o.decoding);
  if (stream && !o.dumps.empty() && stream->kind().name != "probes")
    fail(Exit::usage, "{}: holds no probes, which alone are compared with dumps", o.stream);
  if (!o.dumps.empty()) dumps.emplace(o.dumps, o.frame);
  StoredVolume* const shown = stream ? &*stream : dumps ? &*dumps : nullptr;

  Scene scene = find_scene(o.scene, shown, shown ? shown->facts_at(o.frame) : FrameFacts{});
  if (!o.output.empty())
    check_output(o.output, tools::InputFiles(scene.files), tools::overwrite_if(o.overwrite));
  Client client(o, std::move(scene));
  client.place(shown);
  const Picture picture = client.draw(shown, options);
  if (stream && !stream->missing().empty())
    tools::print(stderr, "gi-render: {}\n", stream->missing());
  if (stream && !stream->loss().empty() && !o.quiet)
    tools::print(stderr, "gi-render: {}: {}\n", o.stream, stream->loss());
  if (stream && !o.quiet) stream->remark_cost();
  if (!o.quiet) client.explain(o.output.empty() ? "the picture" : o.output, picture);
  if (!stream || !dumps) {
    write_picture(o.output, picture, client.exposure(), tools::overwrite_if(o.overwrite));
    return Exit::ok;
  }
  const Picture reference = client.draw(&*dumps, options);
  const PictureDifference found = compare(picture, reference, client.exposure());
  if (!o.output.empty()) {
    write_picture(o.output,
                  o.mode == "difference" ? difference(picture, reference, o.gain) : picture,
                  client.exposure(), tools::overwrite_if(o.overwrite));
  }
  if (!o.quiet) {
    tools::print("{}, frame {}: {} of {} pixels differ", o.stream, o.frame, found.differing,
                 picture.pixels.size());
    if (found.differing > 0)
      tools::print(", PSNR {:.2f} dB, largest difference {:.3g}", found.psnr, found.largest);
    tools::print("\n");
  }
  return o.compare && found.differing > 0 ? Exit::different : Exit::ok;
}

}  // namespace

int main(int argc, char** argv) {
  tools::Command app{
      "Draws a scene as a thin client does: direct light traced, indirect light from decoded "
      "probes.",
      "gi-render"};
  Options options;
  add_flags(app, options);
  app.footer(drawing_help() +
             "The scene may be left out where the textures' attributes name a built-in one.\n\n"
             "Exit codes:\n"
             "  0  success; with --compare no pixel differs\n"
             "  1  --compare found a difference\n"
             "  2  the command line makes no sense, such as an unknown scene\n"
             "  3  a file is damaged, has no such frame, or its volume does not match the scene\n"
             "  4  a file cannot be opened, read or written\n"
             "  5  an internal error, or memory ran out\n"
             "Interrupted, it ends by the signal: 130, 143.\n\n"
             "Examples:\n"
             "  gi-render --scene villa --stream villa.gic --frame 12 -o lit.png\n"
             "  gi-render --stream villa.gic --dumps dumps/villa --frame 12 --compare\n"
             "  gi-render --stream lossy.gic --dumps dumps/villa --mode difference -o diff.png\n"
             "  gi-render --scene street --mode direct --time 2.5 -o direct.exr\n");
  return tools::run_program(app, argc, argv, [&] { return run(options); });
}
