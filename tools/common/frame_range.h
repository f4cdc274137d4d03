// "--frames a-b" and "--frame n".
#pragma once

#include <cstdint>
#include <string>

namespace gicodec::tools {

struct FrameRange {
  std::uint64_t first = 0;
  std::uint64_t last = UINT64_MAX;
  [[nodiscard]] bool contains(std::uint64_t frame) const noexcept {
    return frame >= first && frame <= last;
  }
};

/// Parses "3", "3-7", "3-" or "-7"; empty text: all frames. Throws Error of Exit::usage.
[[nodiscard]] FrameRange frame_range_from_string(const std::string& text);

/// Parses the decimal value of --frame. Throws Error of Exit::usage.
[[nodiscard]] std::uint64_t frame_from_string(const std::string& text);

}  // namespace gicodec::tools
