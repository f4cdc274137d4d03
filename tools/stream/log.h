// Lines for people on standard error. A line that cannot be written, e.g. to a full disk or a
// closed pipe, is lost; the program continues.
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

/// Writes the text unchanged.
inline void log_text(std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
}

/// Writes a line, made printable().
template <typename... Args>
void log_line(fmt::format_string<Args...> format, Args&&... args) noexcept {
  try {
    log_text(tools::printable(fmt::format(format, std::forward<Args>(args)...)) + '\n');
  } catch (...) {  // No memory for it.
    log_text("a line is lost: not enough memory\n");
  }
}

/// Clears the status line of a terminal.
inline void clear_status() noexcept { log_text("\r\033[K"); }

/// Writes the status line of a terminal, made printable().
template <typename... Args>
void show_status(fmt::format_string<Args...> format, Args&&... args) {
  log_text("\r\033[K" + tools::printable(fmt::format(format, std::forward<Args>(args)...)));
}

/// Limits the lines that strangers may cause, so that they cannot fill a disk.
class LogLimit {
 public:
  LogLimit(double burst, double per_second) : burst_(burst), per_second_(per_second) {}

  /// False if the line must be left out.
  [[nodiscard]] bool pass(double now) {
    left_ = std::min(burst_, left_ + std::max(0.0, now - at_) * per_second_);
    at_ = now;
    if (left_ < 1) return ++left_out_, false;
    left_ -= 1;
    return true;
  }
  /// The lines left out since the last call.
  [[nodiscard]] std::uint64_t left_out() { return std::exchange(left_out_, 0); }

 private:
  double burst_, per_second_, left_ = burst_, at_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace gicodec::streaming
