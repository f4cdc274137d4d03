// --max-error: error bounds of decoded texels.
#pragma once

#include "common/command_line.h"

#include <gicodec/record.h>

#include <string>
#include <vector>

namespace gicodec::tools {

/// Adds --max-error; `values` are E or NAME=E, `what` names in help what the bound is for.
void add_error_flag(Command& command, std::vector<std::string>& values, const std::string& what,
                    const std::string& group);
/// The bound of a texture; 0 if none is given. Throws Error of Exit::usage for an invalid value, or
/// one that such records do not allow.
[[nodiscard]] float max_error_for(const std::vector<std::string>& values,
                                  const std::string& texture, const Record& record);
/// Throws Error of Exit::usage if a bound names this texture, which must stay exact.
void refuse_error_of(const std::vector<std::string>& values, const std::string& texture);
/// Throws Error of Exit::usage for a NAME that none of the textures has.
void check_error_names(const std::vector<std::string>& values,
                       const std::vector<std::string>& textures);

}  // namespace gicodec::tools
