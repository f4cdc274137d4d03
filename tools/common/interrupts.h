// Signals that ask a program to end, by interrupts_posix.cpp and interrupts_windows.cpp.
#pragma once

#include <cstdint>
#include <string_view>

namespace gicodec::tools {

/// How SIGINT, SIGTERM and SIGHUP are taken, on Windows Ctrl-C, Ctrl-Break and the console's end.
enum class Interrupts : std::uint8_t {
  noted,  ///< the program looks at them when it does
  /// What waits for a pipe ends as well; a second signal ends the program.
  once,
};
void catch_signals(Interrupts interrupts);
/// The signal that was caught; 0 if there was none. Any thread may ask.
[[nodiscard]] int caught_signal() noexcept;
/// Ends the program as the signal would have, as far as the system has that; else returns what
/// main() is to return.
[[nodiscard]] int end_by(int signal);
/// Writes to standard error and ends the program at once. Allocates nothing.
[[noreturn]] void end_now(int exit, std::string_view words) noexcept;

}  // namespace gicodec::tools
