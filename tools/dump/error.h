// The tools' exception: a message for people, and the program's exit code.
#pragma once

#include "dump/text.h"

#include <gicodec/status.h>

#include <fmt/core.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace gicodec::tools {

/// Exit codes of every tool; see gicodec(1).
enum class Exit : int {
  ok = 0,
  different = 1,  ///< verify and compare: the data differ
  usage = 2,      ///< the command line is invalid
  bad_input = 3,  ///< a file is damaged, or not one that the command can use
  io = 4,         ///< a file cannot be opened, read or written
  internal = 5,   ///< a backend failed, or memory ran out
};

class Error : public std::runtime_error {
 public:
  Error(Exit code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] Exit code() const noexcept { return code_; }

 private:
  Exit code_;
};

/// Throws Error with a message() of the text.
[[noreturn]] void fail_with(Exit code, fmt::string_view format, fmt::format_args arguments);
template <typename... Args>
[[noreturn]] void fail(Exit code, fmt::format_string<Args...> format, const Args&... args) {
  fail_with(code, format, fmt::make_format_args(args...));
}

/// The exit code for a status of the library.
[[nodiscard]] Exit exit_code(Status status) noexcept;

/// Throws Error unless `status` is ok. `where` names the file, frame or texture.
void check(Status status, const std::string& where);

template <typename T>
[[nodiscard]] T take(Result<T> result, const std::string& where) {
  check(result.status(), where);
  return *std::move(result);
}

}  // namespace gicodec::tools
