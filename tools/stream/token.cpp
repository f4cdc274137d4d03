#include "token.h"

#include "dump/error.h"

#include <gicodec/protocol.h>

#include <fstream>

namespace gicodec::streaming {

void add_token_flags(tools::Command& app, TokenFlags& flags) {
  auto* file = app.add_option("--token-file", flags.file,
                              "File whose first line both ends must know; sent in clear")
                   ->type_name("FILE");
  app.add_option("--token", flags.token, "The same on the command line, where others may see it")
      ->type_name("TEXT")
      ->excludes(file);
}

std::string read_token(const TokenFlags& flags) {
  std::string token = flags.token;
  if (!flags.file.empty()) {
    std::ifstream file(flags.file);
    if (!file) tools::fail(tools::Exit::io, "{}: cannot be opened", flags.file);
    std::getline(file, token);
    if (token.empty())
      tools::fail(tools::Exit::bad_input, "{}: its first line is empty", flags.file);
  }
  if (token.size() > kMaxToken)
    tools::fail(tools::Exit::usage, "the token is longer than {} bytes", kMaxToken);
  return token;
}

}  // namespace gicodec::streaming
