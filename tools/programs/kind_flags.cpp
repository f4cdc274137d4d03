#include "kind_flags.h"

#include "common/program.h"
#include "ddgi/scene_id.h"
#include "dump/error.h"

#include <fmt/format.h>

#include <utility>

namespace gicodec::kinds {

void add_kind_flags(tools::Command& app, KindFlags& flags) {
  std::vector<std::string> names;
  for (const TracedKind& kind : traced_kinds()) names.emplace_back(kind.name);
  const std::string group = "Kinds";
  app.add_option("--kind", flags.kind, "Kind of volume")
      ->allow(tools::one_of(names))
      ->show_default()
      ->group(group);
  app.add_option("--set", flags.set,
                 "A setting of a kind other than probes, listed below; may be given several times")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all()
      ->group(group);
  for (const TracedKind& kind : traced_kinds()) {
    if (!kind.flags) continue;
    for (const Setting& setting : kind.settings) {
      app.add_option(fmt::format("--{}", setting.name), flags.own[setting.name],
                     fmt::format("{} (default: {})", setting.summary, setting.usual))
          ->expected(1)
          ->take_all()
          ->group(fmt::format("Settings of {}", kind.name));
    }
  }
}

std::string settings_help() {
  std::string text;
  for (const TracedKind& kind : traced_kinds()) {
    if (kind.flags) continue;
    text += fmt::format("{}: {}\n{}\n", kind.name, kind.summary, help_of(kind.settings));
  }
  return text;
}

void add_drawing_flag(tools::Command& app, DrawingFlags& flags) {
  app.add_option("--set", flags.set,
                 "How light of a kind other than probes is drawn, listed below; may be given "
                 "several times")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all();
}

std::string drawing_help() {
  std::string text;
  for (const TracedKind& kind : traced_kinds()) {
    if (!kind.drawing.empty()) text += fmt::format("{}:\n{}\n", kind.name, help_of(kind.drawing));
  }
  return text;
}

/// Refuses the flags that are given of `names` and of `flags.own`, for `reason`.
static void refuse_given(const tools::Command& app, const KindFlags& flags,
                         std::span<const char* const> names, const std::string& reason) {
  const auto refuse = [&](const std::string& flag) {
    if (app.given(flag)) tools::fail(tools::Exit::usage, "{} is for {}", flag, reason);
  };
  for (const char* const flag : names) refuse(flag);
  for (const auto& [name, values] : flags.own) refuse(fmt::format("--{}", name));
}

void refuse_flags_of_probes(const tools::Command& app, const KindFlags& flags,
                            std::span<const char* const> of_probes) {
  if (traced_kind(flags).flags) return;
  refuse_given(app, flags, of_probes, fmt::format("probes; {} have --set NAME=VALUE", flags.kind));
}

void refuse_flags_of_tracing(const tools::Command& app, const KindFlags& flags,
                             std::span<const char* const> of_tracing) {
  refuse_given(app, flags, of_tracing, "scenes that are traced");
}

void refuse_flags_of_culled(const tools::Command& app, const KindFlags& flags,
                            std::span<const char* const> of_culled) {
  if (traced_kind(flags).culled) return;
  std::vector<std::string_view> names;
  for (const TracedKind& other : traced_kinds()) {
    if (other.culled) names.push_back(other.name);
  }
  for (const char* const flag : of_culled) {
    if (app.given(flag))
      tools::fail(tools::Exit::usage, "{} is for {}; {} are always sent whole", flag,
                  fmt::join(names, " and "), flags.kind);
  }
}

const TracedKind& traced_kind(const KindFlags& flags) { return *find_traced_kind(flags.kind); }

Settings settings_of(const TracedKind& kind, const KindFlags& flags) {
  if (!kind.flags) return {kind.name, kind.settings, flags.set};
  if (!flags.set.empty()) {
    tools::fail(tools::Exit::usage, "--set is for other kinds than {}: name one by --kind",
                kind.name);
  }
  std::vector<std::string> given;
  for (const auto& [name, values] : flags.own) {
    if (!values.empty()) given.push_back(fmt::format("{}={}", name, fmt::join(values, ",")));
  }
  return {kind.name, kind.settings, given, "--"};
}

Feed trace_kind(const KindFlags& flags, ddgi::Scene scene, const std::string& label,
                std::uint32_t seed, unsigned threads) {
  const TracedKind& kind = traced_kind(flags);
  const SceneId id = ddgi::scene_id(label, scene);
  Feed feed =
      kind.trace({std::move(scene), settings_of(kind, flags), seed, threads, tools::interrupted});
  feed.scene = id;
  return feed;
}

}  // namespace gicodec::kinds
