// Lines for a person on standard error. It may be closed, full, or a pipe that nobody reads any
// more: what cannot be written there is lost, and the program goes on.
#pragma once

#include "dump/text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

namespace gicodec::streaming {

/// "1 client", "2 clients".
inline std::string count(std::uint64_t number, std::string_view thing) {
  return fmt::format("{} {}{}", number, thing, number == 1 ? "" : "s");
}

/// As it is.
inline void log_text(std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
}

/// A line, printable().
template <typename... Args>
void log_line(fmt::format_string<Args...> format, Args&&... args) noexcept {
  try {
    log_text(tools::printable(fmt::format(format, std::forward<Args>(args)...)) + '\n');
  } catch (...) {  // No memory for it.
    log_text("a line is lost: not enough memory\n");
  }
}

/// Empties the line on a terminal that shows the present state.
inline void clear_status() noexcept { log_text("\r\033[K"); }

/// Shows the present state there.
template <typename... Args>
void show_status(fmt::format_string<Args...> format, Args&&... args) {
  log_text("\r\033[K" + fmt::format(format, std::forward<Args>(args)...));
}

/// How many lines strangers may cause, so that they cannot fill a disk.
class LogLimit {
 public:
  LogLimit(double burst, double per_second) : burst_(burst), per_second_(per_second) {}

  /// False if the line is to be left out.
  [[nodiscard]] bool pass(double now) {
    left_ = std::min(burst_, left_ + std::max(0.0, now - at_) * per_second_);
    at_ = now;
    if (left_ < 1) return ++left_out_, false;
    left_ -= 1;
    return true;
  }
  /// Since the last call.
  [[nodiscard]] std::uint64_t left_out() { return std::exchange(left_out_, 0); }

 private:
  double burst_, per_second_, left_ = burst_, at_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace gicodec::streaming
