// A secret that both ends know, from a file or the command line.
#pragma once

#include "common/command_line.h"

#include <string>

namespace gicodec::tools {

struct TokenFlags {
  std::string token, file;
};

/// Adds "--token-file FILE" and "--token TEXT"; help says `what` of the file.
void add_token_flags(Command& app, TokenFlags& flags, const std::string& what);

struct Token {
  std::string text;    ///< without the end of the line, if read from a file
  std::string remark;  ///< a fault of that file; empty: none
};
/// Throws Error. Its messages never show the token.
[[nodiscard]] Token read_token(const TokenFlags& flags);

}  // namespace gicodec::tools
