// What the tools throw: a message for a person and the exit code of the program.
#pragma once

#include "dump/text.h"

#include <gicodec/status.h>

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace gicodec::tools {

/// Exit codes of every tool; see gicodec(1).
enum class Exit : int {
  ok = 0,
  different = 1,  ///< verify and compare: the data differ
  usage = 2,      ///< the command line makes no sense
  bad_input = 3,  ///< a file is damaged, or not what the command needs
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

/// Throws; the text becomes a message().
template <typename... Args>
[[noreturn]] void fail(Exit code, fmt::format_string<Args...> format, Args&&... args) {
  throw Error(code, message(fmt::format(format, std::forward<Args>(args)...)));
}

/// The exit code that fits a status of the library.
[[nodiscard]] inline Exit exit_code(Status status) noexcept {
  if (status == Status::io_failed) return Exit::io;
  if (status == Status::unsupported_format) return Exit::bad_input;
  switch (static_cast<int>(status) / 100) {
    case 0:
      return Exit::ok;
    case 1:
      return Exit::usage;
    case 3:
    case 4:
      return Exit::bad_input;
    default:
      return status == Status::limit_exceeded ? Exit::bad_input : Exit::internal;
  }
}

/// Throws unless `status` is ok. `where` names the file, frame or texture.
inline void check(Status status, const std::string& where) {
  if (status != Status::ok) fail(exit_code(status), "{}: {}", where, to_string(status));
}

template <typename T>
[[nodiscard]] T take(Result<T> result, const std::string& where) {
  check(result.status(), where);
  return *std::move(result);
}

}  // namespace gicodec::tools
