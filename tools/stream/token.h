// The shared secret of server and clients.
#pragma once

#include "common/command_line.h"

#include <string>

namespace gicodec::streaming {

struct TokenFlags {
  std::string token, file;
};

void add_token_flags(tools::Command& app, TokenFlags& flags);

struct Token {
  std::string text;    ///< without the end of the line, if read from a file
  std::string remark;  ///< a fault of that file; empty: none
};
/// Throws tools::Error. Its messages never show the token.
[[nodiscard]] Token read_token(const TokenFlags& flags);

}  // namespace gicodec::streaming
