// Many sequences on many machines: plans of encode commands, each of which can be run again.
#pragma once

#include "common/cli.h"

#include <string>
#include <vector>

namespace gicodec::tools {

/// Prints a command line for each job of a manifest. Throws Error of Exit::usage or bad_input that
/// names the manifest and the job.
Exit write_plan(const std::string& manifest, const Cli& cli);

/// True if a container is there that was made by `flags`, as the metadata "flags" says, is whole
/// and gives back its dumps, within `max_error`; of one that is `lossy` only that it is whole.
[[nodiscard]] bool is_finished(const std::string& container, const std::string& flags,
                               const std::vector<std::string>& dumps,
                               const std::vector<std::string>& max_error, bool lossy,
                               unsigned threads);
/// Name of that metadata, of the file.
inline constexpr const char* kFlagsKey = "flags";

}  // namespace gicodec::tools
