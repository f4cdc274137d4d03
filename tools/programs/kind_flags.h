// Flags of gi-trace and gi-server that choose what kind of light is traced, and how.
#pragma once

#include "kind_table.h"

#include "common/command_line.h"
#include "scene_flags.h"

#include <map>
#include <span>
#include <string>
#include <vector>

namespace gicodec::kinds {

struct KindFlags {
  std::string kind = "probes";
  std::vector<std::string> set;  ///< NAME=VALUE
  /// Values of the flags that kinds have for their own settings, by setting.
  std::map<std::string_view, std::vector<std::string>> own;
};

/// Adds --kind, --set, and the kinds' own flags.
void add_kind_flags(tools::Command& app, KindFlags& flags);
/// The kinds without flags of their own and their settings, for the end of --help.
[[nodiscard]] std::string settings_help();
/// --set of a client that draws, and its settings for the end of --help.
void add_drawing_flag(tools::Command& app, DrawingFlags& flags);
[[nodiscard]] std::string drawing_help();
/// Throws tools::Error of Exit::usage if another kind than probes is traced and a kind's own flag,
/// or one of `of_probes`, was given.
void refuse_flags_of_probes(const tools::Command& app, const KindFlags& flags,
                            std::span<const char* const> of_probes);
/// Throws tools::Error of Exit::usage if a kind's own flag, or one of `of_tracing`, was given.
void refuse_flags_of_tracing(const tools::Command& app, const KindFlags& flags,
                             std::span<const char* const> of_tracing);
/// Throws tools::Error of Exit::usage if the kind is not culled and one of `of_culled` was given.
void refuse_flags_of_culled(const tools::Command& app, const KindFlags& flags,
                            std::span<const char* const> of_culled);
[[nodiscard]] const TracedKind& traced_kind(const KindFlags& flags);
/// Throws tools::Error of Exit::usage for settings that the kind does not have, or has as flags.
[[nodiscard]] Settings settings_of(const TracedKind& kind, const KindFlags& flags);
/// A feed that traces the kind in a scene named `label`. Throws tools::Error, and ddgi::Cancelled
/// when the program is interrupted.
[[nodiscard]] Feed trace_kind(const KindFlags& flags, ddgi::Scene scene, const std::string& label,
                              std::uint32_t seed, unsigned threads);

}  // namespace gicodec::kinds
