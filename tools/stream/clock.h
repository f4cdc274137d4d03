// Seconds on a clock that does not go backwards.
#pragma once

#include <chrono>

namespace gicodec::streaming {

[[nodiscard]] inline double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace gicodec::streaming
