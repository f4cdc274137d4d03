// The frame of all programs: parsing, exit codes, interrupts.
#pragma once

#include "command_line.h"
#include "dump/error.h"
#include "interrupts.h"

#include <functional>
#include <string>

namespace gicodec::tools {

/// Thrown by check_interrupt(), so that temporary files are removed.
struct Interrupted {
  int signal;
};
/// To be called now and then in long work.
void check_interrupt();
/// For programs that end in their own way after a signal. Any thread may ask.
[[nodiscard]] bool interrupted() noexcept;

/// Parses and runs; returns what main() is to return. Errors go to standard error behind the
/// program's name. `formats`: what --version prints besides.
int run_program(Command& app, int argc, char** argv, const std::function<Exit()>& run,
                Interrupts interrupts = Interrupts::noted, const std::string& formats = "");

}  // namespace gicodec::tools
