#include "trace_flags.h"

#include "dump/dump.h"
#include "dump/error.h"
#include "dump_folder.h"
#include "engine_textures.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace gicodec::ddgi {
namespace {

using tools::Exit;
using tools::fail;

/// "color=VALUE" or "vis=VALUE": which texture, and the value.
struct ForTexture {
  bool color = false;
  std::string_view value;
};
ForTexture for_texture(std::string_view text, const char* flag, const char* example) {
  for (const std::string_view name : {kColorName, kVisibilityName}) {
    if (text.starts_with(name) && text.substr(name.size()).starts_with('='))
      return {name == kColorName, text.substr(name.size() + 1)};
  }
  fail(Exit::usage, "{}: \"{}\" does not begin with {}= or {}=; expected such as {}", flag, text,
       kColorName, kVisibilityName, example);
}

Format format_of(const ForTexture& text) {
  const auto known = text.color ? color_formats() : visibility_formats();
  const FormatInfo* info = find_format(text.value);
  if (info == nullptr || std::find(known.begin(), known.end(), info->record.format) == known.end())
    fail(Exit::usage, "--vk-format: {} cannot be {}; there are {}",
         text.color ? kColorName : kVisibilityName, text.value, names_of(known));
  return info->record.format;
}

std::uint8_t core_of(const ForTexture& text) {
  unsigned core = 0;
  const char* const end = text.value.data() + text.value.size();
  const auto parsed = std::from_chars(text.value.data(), end, core);
  if (parsed.ec != std::errc{} || parsed.ptr != end || core < 2 || core > kMaxBlockSide)
    fail(Exit::usage, "--core: expected 2 to {} texels, not \"{}\"", kMaxBlockSide, text.value);
  return static_cast<std::uint8_t>(core);
}

std::string layouts() {
  std::string names;
  for (const EngineLayout& layout : engine_layouts()) {
    names += (names.empty() ? "" : ", ") + std::string(layout.name);
  }
  return names;
}

/// Textures of an engine instead of the tracer's own.
void resolve_layout(TraceFlags& o) {
  o.engine = find_engine_layout(o.layout);
  if (o.engine == nullptr)
    fail(Exit::usage, "--layout: {} is not known; there are {}", o.layout, layouts());
  if (!o.formats.empty() || !o.cores.empty() || o.sh != "none")
    fail(Exit::usage,
         "--layout says what textures there are; leave out --vk-format, --core and --sh");
  o.trace.forms = forms_of(*o.engine);
  if (const auto encoding = encoding_from_string(o.encoding)) o.trace.forms.encoding = *encoding;
}

}  // namespace

std::string usual_files(const TraceFlags& o) {
  return o.engine == nullptr || o.engine->unit == GridUnit::probe ? "exr" : "gic";
}

void add_flags(tools::Command& app, TraceFlags& o) {
  add_scene_flags(app, o.scene);
  kinds::add_kind_flags(app, o.kind);
  app.add_option("-o,--output", o.output,
                 "Folder for the dumps; the container of another kind than probes")
      ->type_name("DIR|FILE.gic");
  app.add_option("--frames", o.frames, "Frames to trace")
      ->allow(tools::in_range(1, 1000000))
      ->show_default();
  app.add_option("--fps", o.fps, "Frames per second of the scene's time")
      ->allow(tools::in_range(0.001, 1e6))
      ->show_default();
  app.add_option("--start", o.start, "Time of frame 0 in seconds")
      ->allow(tools::in_range(0.0, 1e6))
      ->show_default();
  app.add_option(
         "--mode", o.mode,
         "converged: fixed rays, all bounces, what is static repeats bit for bit; noisy: rays "
         "turn at every update and are blended into the past")
      ->allow(tools::one_of({"converged", "noisy"}))
      ->show_default();
  app.add_option("--rays", o.trace.rays, "Rays per probe")
      ->allow(tools::in_range(1, 65536))
      ->show_default();
  app.add_option("--hysteresis", o.trace.hysteresis, "noisy: share of the past in each update")
      ->allow(tools::in_range(0.0, 1.0))
      ->show_default();
  app.add_option("--warmup", o.warmup, "noisy: updates before frame 0")
      ->allow(tools::in_range(0, 100000))
      ->show_default();
  app.add_option("--seed", o.trace.seed, "Of the rays' rotation")->show_default();
  app.add_option("--rotation", o.rotation,
                 "Rays that are the same in all updates, or turn at every one; default: fixed if "
                 "converged, turning if noisy")
      ->allow(tools::one_of({"fixed", "turning"}));
  app.add_option("--clamp", o.trace.clamp,
                 "Most radiance that a ray brings in a channel, against fireflies; default: any")
      ->allow(tools::in_range(1e-6, 1e6))
      ->type_name("MAX");
  app.add_option("--irradiance-threshold", o.trace.irradiance_threshold,
                 "noisy: where a channel falls by more, the past counts 0.75 less; default: never")
      ->allow(tools::in_range(0.0, 1e6))
      ->type_name("T");
  app.add_option("--brightness-threshold", o.trace.brightness_threshold,
                 "noisy: of a change by more a quarter is taken; default: never")
      ->allow(tools::in_range(0.0, 1e6))
      ->type_name("T");
  const std::string group = "Textures";
  app.add_option("--vk-format", o.formats,
                 "Texel format: color=" + names_of(color_formats()) +
                     "; vis=" + names_of(visibility_formats()) + "; the first ones if not given")
      ->type_name("NAME=FORMAT")
      ->group(group)
      ->expected(1)
      ->take_all();
  app.add_option("--core", o.cores,
                 "Texels per block side without guard band; default: color=8, vis=16")
      ->type_name("NAME=N")
      ->group(group)
      ->expected(1)
      ->take_all();
  app.add_option("--encoding", o.encoding,
                 "How colour is stored; default: gamma5 for unorm, linear for floats")
      ->allow(tools::one_of({"gamma5", "linear"}))
      ->group(group);
  app.add_option(
         "--sh", o.sh,
         "Also write spherical harmonics, one texel per probe: l1 and l2 as halves for each "
         "colour; l1-over-l0: as Unity's probe volumes, ratios in 8 bits")
      ->allow(tools::one_of({"none", "l1", "l2", "l1-over-l0"}))
      ->group(group)
      ->show_default();
  app.add_option("--layout", o.layout, "The textures of an engine instead: " + layouts())
      ->type_name("NAME")
      ->group(group);
  app.add_option("--files", o.files,
                 "Files that the textures are written as, one for each and frame, or gic: all "
                 "frames in one container; default: exr, and gic for layouts that have no probes")
      ->allow(tools::one_of({"exr", "dds", "ktx2", "raw", "gic"}))
      ->group(group);
  app.add_option("--view-samples", o.view_samples,
                 "Also write views.jsonl: N first-hit positions around each frame's camera")
      ->allow(tools::in_range(0, 1000000))
      ->type_name("N");
  app.add_option("--export-gltf", o.export_gltf,
                 "Write the scene as .glb, with --frames of its motion")
      ->type_name("FILE");
  app.add_flag("--list-scenes", o.list, "List the built-in scenes");
  auto* overwrite =
      app.add_flag("--overwrite", o.overwrite,
                   "Replace what an earlier trace wrote, when all is traced, and the file of "
                   "--export-gltf");
  app.add_flag("--resume", o.resume,
               "converged: keep the frames that an interrupted trace with the same options wrote")
      ->excludes(overwrite);
  app.add_option("--threads", o.threads, "Threads to use; default: one per processor")
      ->allow(tools::in_range(1, 256));
  app.add_flag("-q,--quiet", o.quiet, "No progress and no summary");
}

void check_kind(const tools::Command& app, const TraceFlags& o) {
  constexpr std::array kOfProbes{"--grid",
                                 "--bounds",
                                 "--mode",
                                 "--rays",
                                 "--hysteresis",
                                 "--warmup",
                                 "--rotation",
                                 "--clamp",
                                 "--irradiance-threshold",
                                 "--brightness-threshold",
                                 "--vk-format",
                                 "--core",
                                 "--encoding",
                                 "--sh",
                                 "--layout",
                                 "--files",
                                 "--view-samples",
                                 "--resume"};
  kinds::refuse_flags_of_probes(app, o.kind, kOfProbes);
}

void resolve(TraceFlags& o) {
  o.trace.mode = o.mode == "noisy" ? TraceMode::noisy : TraceMode::converged;
  o.trace.rotation = o.rotation == "fixed"     ? Rotation::fixed
                     : o.rotation == "turning" ? Rotation::turning
                                               : Rotation::by_mode;
  TextureForms& forms = o.trace.forms;
  for (const std::string& text : o.formats) {
    const auto one = for_texture(text, "--vk-format", "color=R16G16B16A16_SFLOAT");
    (one.color ? forms.color : forms.visibility) = format_of(one);
  }
  for (const std::string& text : o.cores) {
    const auto one = for_texture(text, "--core", "color=6");
    (one.color ? forms.color_core : forms.visibility_core) = core_of(one);
  }
  forms.encoding = encoding_from_string(o.encoding).value_or(usual_encoding(forms.color));
  for (const ShForm form : {ShForm::l1, ShForm::l2, ShForm::l1_over_l0}) {
    if (o.sh == to_string(form)) forms.sh = form;
  }
  if (!o.layout.empty()) resolve_layout(o);
  if (o.files.empty()) o.files = usual_files(o);
}

std::string settings(const TraceFlags& o, const VolumeShape& shape) {
  const auto array = [](Vec3 v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
  nlohmann::ordered_json all{{"scene", scene_label(o.scene)},
                             {"grid", tools::to_string(shape.grid)},
                             {"origin", array(shape.origin)},
                             {"spacing", array(shape.spacing)},
                             {"start", o.start},
                             {"fps", o.fps},
                             {"mode", o.mode},
                             {"rays", o.trace.rays},
                             {"seed", o.trace.seed}};
  if (!o.rotation.empty()) all["rotation"] = o.rotation;
  if (std::isfinite(o.trace.clamp)) all["clamp"] = o.trace.clamp;
  const TextureForms& forms = o.trace.forms;
  const TextureForms usual;
  const auto name = [](Format format) { return std::string(find_format(format)->name); };
  if (forms.color != usual.color) all["color"] = name(forms.color);
  if (forms.visibility != usual.visibility) all["vis"] = name(forms.visibility);
  if (forms.color_core != usual.color_core) all["color core"] = forms.color_core;
  if (forms.visibility_core != usual.visibility_core) all["vis core"] = forms.visibility_core;
  if (forms.encoding != usual_encoding(forms.color))
    all["encoding"] = std::string(to_string(forms.encoding));
  if (forms.sh != ShForm::none) all["sh"] = o.sh;
  if (o.engine != nullptr) {
    all["layout"] = o.layout;
    all["layout grid"] = tools::to_string(layout_grid(*o.engine, shape.grid));
  }
  if (o.files != usual_files(o)) all["files"] = o.files;
  if (o.trace.mode == TraceMode::noisy) {
    if (std::isfinite(o.trace.irradiance_threshold))
      all["irradiance threshold"] = o.trace.irradiance_threshold;
    if (std::isfinite(o.trace.brightness_threshold))
      all["brightness threshold"] = o.trace.brightness_threshold;
    all["hysteresis"] = o.trace.hysteresis;
    all["warmup"] = o.warmup;
  }
  return all.dump(1) + "\n";
}

}  // namespace gicodec::ddgi
