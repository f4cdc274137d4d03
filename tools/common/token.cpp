#include "token.h"

#include "dump/error.h"

#include <gicodec/protocol.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

namespace gicodec::tools {

void add_token_flags(Command& app, TokenFlags& flags, const std::string& what) {
  auto* file = app.add_option("--token-file", flags.file, what)->type_name("FILE");
  app.add_option("--token", flags.token, "The same on the command line, where others may see it")
      ->type_name("TEXT")
      ->excludes(file);
}

/// The first line, or of a longer one more than a token may have.
static std::string first_line(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "r"),
                                                             std::fclose);
  std::string bytes(kMaxToken + 2, '\0');
  if (file) bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
  if (!file || std::ferror(file.get()) != 0) {
    fail(Exit::io, "{}: cannot be read: {}; --token-file takes a file that this user may read",
         path, std::strerror(errno));
  }
  std::string line = bytes.substr(0, bytes.find('\n'));
  if (line.ends_with('\r')) line.pop_back();
  return line;
}

Token read_token(const TokenFlags& flags) {
  Token token{flags.token, ""};
  if (!flags.file.empty()) {
    token.text = first_line(flags.file);
    if (token.text.empty())
      fail(Exit::bad_input, "{}: its first line is empty; write the token there", flags.file);
    using std::filesystem::perms;
    std::error_code error;
    const auto file = std::filesystem::status(flags.file, error);
    if (!error && std::filesystem::is_regular_file(file) &&
        (file.permissions() & (perms::group_read | perms::others_read)) != perms::none) {
      token.remark = fmt::format("{0}: others may read the token; chmod 600 {0}", flags.file);
    }
  }
  if (token.text.size() > kMaxToken)
    fail(Exit::usage, "the token is longer than {} bytes; use a shorter one", kMaxToken);
  return token;
}

}  // namespace gicodec::tools
