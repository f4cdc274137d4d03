// The frame of all programs here: parsing, exit codes, interrupts.
#pragma once

#include "common/command_line.h"
#include "dump/error.h"

#include <functional>

namespace gicodec::ddgi {

/// Thrown by check_interrupt(), so that temporary files are removed.
struct Interrupted {
  int signal;
};
/// To be called now and then in long work.
void check_interrupt();
/// For programs that end in their own way after SIGINT, SIGTERM or SIGHUP. Any thread may ask.
[[nodiscard]] bool interrupted() noexcept;

/// Parses and runs; returns what main() is to return. Errors go to standard error behind the
/// program's name.
int run_program(tools::Command& app, int argc, char** argv,
                const std::function<tools::Exit()>& run);

}  // namespace gicodec::ddgi
