// --max-error: how far decoded texels may be off.
#pragma once

#include "common/command_line.h"

#include <gicodec/record.h>

#include <string>
#include <vector>

namespace gicodec::tools {

/// Adds --max-error; `values` are E or NAME=E, `what` says what may be off.
void add_error_flag(Command& command, std::vector<std::string>& values, const std::string& what,
                    const std::string& group);
/// That of a texture; 0 if none is given. Throws Error of Exit::usage for a value that makes no
/// sense, or none for such records.
[[nodiscard]] float max_error_for(const std::vector<std::string>& values,
                                  const std::string& texture, const Record& record);
/// Throws Error of Exit::usage where one is given for this texture by its name: every bit counts.
void refuse_error_of(const std::vector<std::string>& values, const std::string& texture);
/// Throws Error of Exit::usage for a NAME that none of the textures has.
void check_error_names(const std::vector<std::string>& values,
                       const std::vector<std::string>& textures);

}  // namespace gicodec::tools
