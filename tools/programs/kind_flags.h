// Which kind of payload is traced, and how: shared by gi-trace and gi-server.
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
  /// What the flags were given of kinds that have some of their own, by setting.
  std::map<std::string_view, std::vector<std::string>> own;
};

/// --kind and --set, with the names of all kinds, and the flags of kinds that have some.
void add_kind_flags(tools::Command& app, KindFlags& flags);
/// The kinds without flags of their own and their settings, for the end of --help.
[[nodiscard]] std::string settings_help();
/// --set of a client that draws, and its settings for the end of --help.
void add_drawing_flag(tools::Command& app, DrawingFlags& flags);
[[nodiscard]] std::string drawing_help();
/// Throws tools::Error of Exit::usage where another kind is traced and a flag of a kind, or one of
/// these, which are for probes, was given.
void refuse_flags_of_probes(const tools::Command& app, const KindFlags& flags,
                            std::span<const char* const> of_probes);
/// Likewise where viewers are sent all of what is traced, and one of these, which are for what is
/// culled, was given.
void refuse_flags_of_culled(const tools::Command& app, const KindFlags& flags,
                            std::span<const char* const> of_culled);
[[nodiscard]] const TracedKind& traced_kind(const KindFlags& flags);
/// Throws tools::Error of Exit::usage for settings that the kind does not have, or has as flags.
[[nodiscard]] Settings settings_of(const TracedKind& kind, const KindFlags& flags);
/// Traces that kind in the scene of this name, of which the source tells. Throws tools::Error. Ends
/// by ddgi::Cancelled when the program is interrupted.
[[nodiscard]] Source trace_kind(const KindFlags& flags, ddgi::Scene scene, const std::string& label,
                                std::uint32_t seed, unsigned threads);

}  // namespace gicodec::kinds
