// Seconds on a clock that does not go backwards, and the time of day for people.
#pragma once

#include <fmt/core.h>

#include <chrono>
#include <cstdint>
#include <ctime>
#include <string>

namespace gicodec::streaming {

[[nodiscard]] inline double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The time of day in seconds since 1970.
[[nodiscard]] inline std::uint64_t unix_seconds() {
  using namespace std::chrono;
  return static_cast<std::uint64_t>(
      duration_cast<seconds>(system_clock::now().time_since_epoch()).count());
}

/// ISO 8601 in UTC: "2026-11-21T20:52:11.123Z".
[[nodiscard]] inline std::string utc_time() {
  using namespace std::chrono;
  const auto ticks = duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
  const std::time_t seconds = ticks / 1000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts);
  return fmt::format("{}.{:03}Z", text, ticks % 1000);
}

}  // namespace gicodec::streaming
