#include "probes.h"

#include "probe_volume_light.h"

#include "dump/dump.h"
#include "dump/error.h"

#include <gicodec/engines.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <utility>

namespace gicodec::probes {
namespace {

using kinds::Setting;
using tools::Exit;
using tools::fail;

constexpr std::array kSettings{
    Setting{"mode", "converged",
            "converged: fixed rays, all bounces, what is static repeats bit for bit; noisy: rays "
            "turn at every update and are blended into the past"},
    Setting{"rays", "256", "per probe, 1 to 65536"},
    Setting{"hysteresis", "0.97", "noisy: share of the past in each update, 0 to 1"},
    Setting{"warmup", "32", "noisy: updates before frame 0, 0 to 100000"},
    Setting{"rotation", "mode",
            "of rays: fixed, the same in all updates; turning; mode, fixed if converged"},
    Setting{"clamp", "none",
            "most radiance that a ray brings in a channel, against fireflies, 1e-6 to 1e6"},
    Setting{"irradiance-threshold", "none",
            "noisy: where a channel falls by more, the past counts 0.75 less, 0 to 1e6"},
    Setting{"brightness-threshold", "none",
            "noisy: of a change by more a quarter is taken, 0 to 1e6"},
    Setting{"vk-format", "paper", "of texels, color=FORMAT or vis=FORMAT; may be given for both"},
    Setting{"core", "paper",
            "texels per block side without guard band, color=N or vis=N, 2 to 64; paper: 8 and 16"},
    Setting{"encoding", "format",
            "how colour is stored: gamma5, linear; format: gamma5 for unorm, linear for floats"},
    Setting{"sh", "none",
            "also spherical harmonics, one texel per probe: l1 and l2 as halves for each colour; "
            "l1-over-l0: as Unity's probe volumes, ratios in 8 bits"},
    Setting{"layout", "none",
            "the textures of an engine instead: paper, g3d, rtxgi, rtxgi-float16, rtxgi-float32, "
            "rtxgi-z-up, o3de, flax, unity-apv, unity-apv-l1, unreal-vlm, bevy, three, "
            "three-float32, godot"},
    Setting{"fine", "none",
            "also a finer volume, NXxNYxNZ, that moves with the first client's eye, or with the "
            "scene's camera"},
    Setting{"fine-spacing", "0.5", "metres between its probes, 0.01 to 1000"}};

constexpr std::array<std::string_view, 2> kModes{"converged", "noisy"};
constexpr std::array<std::string_view, 3> kRotations{"mode", "fixed", "turning"};
constexpr std::array<std::string_view, 3> kEncodings{"gamma5", "linear", "format"};
constexpr std::array<std::string_view, 4> kShForms{"none", "l1", "l2", "l1-over-l0"};
constexpr std::string_view kColor = "color=", kVisibility = "vis=";

/// Calls take(of colour, text) for each "color=TEXT" and "vis=TEXT" of a list with commas.
template <typename Take>
void for_textures(const kinds::Settings& settings, std::string_view name, const char* example,
                  const Take& take) {
  std::string_view left = settings.text(name);
  if (left == "paper") return;
  while (true) {
    const std::string_view one = left.substr(0, left.find(','));
    const bool color = one.starts_with(kColor);
    if (!color && !one.starts_with(kVisibility))
      fail(Exit::usage, "--{}: \"{}\" does not begin with {} or {}; expected such as {}", name, one,
           kColor, kVisibility, example);
    take(color, one.substr(color ? kColor.size() : kVisibility.size()));
    if (one.size() == left.size()) return;
    left.remove_prefix(one.size() + 1);
  }
}

Format format_of(bool color, std::string_view name) {
  const auto known = color ? ddgi::color_formats() : ddgi::visibility_formats();
  const FormatInfo* info = find_format(name);
  if (info == nullptr || std::ranges::find(known, info->record.format) == known.end())
    fail(Exit::usage, "--vk-format: {} cannot be {}; there are {}", color ? "color" : "vis", name,
         ddgi::names_of(known));
  return info->record.format;
}

std::uint8_t core_of(std::string_view text) {
  unsigned core = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, core);
  if (parsed.ec != std::errc{} || parsed.ptr != end || core < 2 || core > kMaxBlockSide)
    fail(Exit::usage, "--core: expected 2 to {} texels, not \"{}\"", kMaxBlockSide, text);
  return static_cast<std::uint8_t>(core);
}

/// A limit, or none.
float limit_of(const kinds::Settings& settings, std::string_view name, double least) {
  if (settings.text(name) == "none") return ddgi::TraceOptions::kNoLimit;
  return static_cast<float>(settings.number(name, least, 1e6));
}

const EngineLayout* layout_of(const kinds::Settings& settings) {
  const std::string& name = settings.text("layout");
  if (name == "none") return nullptr;
  const EngineLayout* const layout = find_engine_layout(name);
  if (layout == nullptr) {
    fail(Exit::usage, "--layout: {} is not known; there are {}", name,
         tools::listed(engine_layouts(), &EngineLayout::name));
  }
  const bool others = settings.text("vk-format") != "paper" || settings.text("core") != "paper" ||
                      settings.text("sh") != "none" || settings.text("fine") != "none";
  if (others)
    fail(Exit::usage,
         "--layout says what textures there are; leave out --vk-format, --core, --sh and --fine");
  return layout;
}

ddgi::TextureForms forms_of(const kinds::Settings& settings, const EngineLayout* layout) {
  ddgi::TextureForms forms;
  if (layout != nullptr) forms = ddgi::forms_of(*layout);
  for_textures(settings, "vk-format", "color=R16G16B16A16_SFLOAT",
               [&](bool color, std::string_view text) {
                 (color ? forms.color : forms.visibility) = format_of(color, text);
               });
  for_textures(settings, "core", "color=6", [&](bool color, std::string_view text) {
    (color ? forms.color_core : forms.visibility_core) = core_of(text);
  });
  const std::string_view encoding = kEncodings[settings.choice("encoding", kEncodings)];
  if (const auto given = ddgi::encoding_from_string(encoding)) {
    forms.encoding = *given;
  } else if (layout == nullptr) {
    forms.encoding = ddgi::usual_encoding(forms.color);
  }
  const std::string_view sh = kShForms[settings.choice("sh", kShForms)];
  for (const ddgi::ShForm form : {ddgi::ShForm::l1, ddgi::ShForm::l2, ddgi::ShForm::l1_over_l0}) {
    if (sh == to_string(form)) forms.sh = form;
  }
  return forms;
}

std::optional<FineVolume> fine_of(const kinds::Settings& settings) {
  const float spacing = static_cast<float>(settings.number("fine-spacing", 0.01, 1000));
  const std::string& text = settings.text("fine");
  if (text == "none") return std::nullopt;
  const auto grid = tools::grid_from_string(text);
  if (!grid || validate(VolumeGeometry{*grid}) != Status::ok)
    fail(Exit::usage, "--fine: expected a grid such as 8x4x8, not \"{}\"", text);
  return FineVolume{*grid, spacing};
}

kinds::Feed trace(kinds::TraceRequest request) {
  const auto server = std::make_shared<ProbeServer>(std::move(request.scene),
                                                    options_of(request.settings, request.seed),
                                                    request.threads, std::move(request.cancelled));
  return {server->volumes(),
          {},
          false,
          [server](const kinds::FeedRequest& wanted) { return server->next(wanted); },
          server->remarks()};
}

std::unique_ptr<kinds::VolumeLight> light(const ddgi::RayScene& /*scene*/,
                                          const VolumeDesc& /*desc*/,
                                          const kinds::Settings& /*drawing*/) {
  return std::make_unique<ProbeVolumeLight>();
}

/// The textures in the order of cells, and their texels as floats.
std::uint64_t light_memory(const VolumeDesc& /*desc*/, std::uint64_t textures) {
  return 6 * textures;
}

}  // namespace

constinit const kinds::TracedKind kTracedProbes{.name = "probes",
                                                .summary = "probes of irradiance and visibility",
                                                .settings = kSettings,
                                                .drawing = {},
                                                .trace = trace,
                                                .light = light,
                                                .light_memory = light_memory,
                                                .culled = true,
                                                .flags = true};

ProbeOptions options_of(const kinds::Settings& settings, std::uint32_t seed) {
  ProbeOptions options;
  ddgi::TraceOptions& trace = options.trace;
  trace.mode =
      settings.choice("mode", kModes) == 1 ? ddgi::TraceMode::noisy : ddgi::TraceMode::converged;
  trace.rays = settings.whole("rays", 1, 65536);
  trace.hysteresis = static_cast<float>(settings.number("hysteresis", 0, 1));
  trace.seed = seed;
  trace.rotation = static_cast<ddgi::Rotation>(settings.choice("rotation", kRotations));
  trace.clamp = limit_of(settings, "clamp", 1e-6);
  trace.irradiance_threshold = limit_of(settings, "irradiance-threshold", 0);
  trace.brightness_threshold = limit_of(settings, "brightness-threshold", 0);
  options.warmup = settings.whole("warmup", 0, 100000);
  options.layout = layout_of(settings);
  trace.forms = forms_of(settings, options.layout);
  options.fine = fine_of(settings);
  return options;
}

}  // namespace gicodec::probes
