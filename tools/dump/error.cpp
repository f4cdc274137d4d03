#include "dump/error.h"

#include <fmt/format.h>

namespace gicodec::tools {

void fail_with(Exit code, fmt::string_view format, fmt::format_args arguments) {
  throw Error(code, message(fmt::vformat(format, arguments)));
}

Exit exit_code(Status status) noexcept {
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

void check(Status status, const std::string& where) {
  if (status != Status::ok) fail(exit_code(status), "{}: {}", where, to_string(status));
}

}  // namespace gicodec::tools
