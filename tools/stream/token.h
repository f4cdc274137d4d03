// The shared secret of server and clients.
#pragma once

#include "command_line/command_line.h"

#include <string>

namespace gicodec::streaming {

struct TokenFlags {
  std::string token, file;
};

void add_token_flags(tools::Command& app, TokenFlags& flags);
/// The token, without the line's end where it is read from a file. Throws tools::Error; messages
/// never show it.
[[nodiscard]] std::string read_token(const TokenFlags& flags);

}  // namespace gicodec::streaming
