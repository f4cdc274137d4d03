#include "kind_flags.h"

#include "ddgi/program.h"
#include "ddgi/scene_id.h"
#include "dump/error.h"

#include <fmt/core.h>

namespace gicodec::kinds {

void add_kind_flags(tools::Command& app, KindFlags& flags) {
  std::vector<std::string> names{"probes"};
  for (const TracedKind& kind : traced_kinds()) names.emplace_back(kind.name);
  const std::string group = "Kinds";
  app.add_option("--kind", flags.kind, "Kind of payload")
      ->allow(tools::one_of(names))
      ->show_default()
      ->group(group);
  app.add_option("--set", flags.set,
                 "A setting of a kind other than probes, listed below; may be given several times")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all()
      ->group(group);
}

std::string settings_help() {
  std::string text;
  for (const TracedKind& kind : traced_kinds()) {
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

void refuse_flags_of_probes(const tools::Command& app, const KindFlags& flags,
                            std::span<const char* const> of_probes) {
  if (traced_kind(flags) == nullptr) return;
  for (const char* const flag : of_probes) {
    if (app.given(flag))
      tools::fail(tools::Exit::usage, "{} is for probes; {} have --set NAME=VALUE", flag,
                  flags.kind);
  }
}

void refuse_flags_of_culled(const tools::Command& app, const KindFlags& flags,
                            std::span<const char* const> of_culled) {
  const TracedKind* const kind = traced_kind(flags);
  if (kind == nullptr || kind->culled) return;
  std::string names = "probes";
  for (const TracedKind& other : traced_kinds()) {
    if (other.culled) names += fmt::format(" and {}", other.name);
  }
  for (const char* const flag : of_culled) {
    if (app.given(flag))
      tools::fail(tools::Exit::usage, "{} is for {}; {} are always sent whole", flag, names,
                  flags.kind);
  }
}

const TracedKind* traced_kind(const KindFlags& flags) {
  const TracedKind* kind = find_traced_kind(flags.kind);
  if (kind == nullptr && !flags.set.empty())
    tools::fail(tools::Exit::usage, "--set is for other kinds than probes: name one by --kind");
  return kind;
}

Source trace_kind(const TracedKind& kind, const KindFlags& flags, const ddgi::SceneFlags& scene,
                  std::uint32_t seed, unsigned threads) {
  Settings settings(kind.name, kind.settings, flags.set);
  ddgi::Scene loaded = ddgi::load_scene(scene);
  const SceneId id = ddgi::scene_id(ddgi::scene_label(scene), loaded);
  Source source =
      kind.trace({std::move(loaded), std::move(settings), seed, threads, ddgi::interrupted});
  source.scene = id;
  return source;
}

}  // namespace gicodec::kinds
