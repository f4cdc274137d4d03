#include "frame_range.h"

#include "dump/error.h"

#include <charconv>

namespace gicodec::tools {

FrameRange frame_range_from_string(const std::string& text) {
  FrameRange range;
  if (text.empty()) return range;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto number = [&](std::uint64_t& value) {
    const auto parsed = std::from_chars(at, end, value);
    const bool found = parsed.ec == std::errc{};
    if (found) at = parsed.ptr;
    return found;
  };
  const bool has_first = number(range.first);
  bool has_last = false;
  if (at != end && *at == '-') {
    ++at;
    has_last = number(range.last);
  } else {
    range.last = range.first;
  }
  if (at != end || (!has_first && !has_last) || range.last < range.first) {
    fail(Exit::usage, "--frames does not take \"{}\"; expected A-B, A-, -B or A", text);
  }
  return range;
}

std::uint64_t frame_from_string(const std::string& text) {
  std::uint64_t frame = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, frame);
  if (parsed.ec != std::errc{} || parsed.ptr != end) {
    fail(Exit::usage, "--frame does not take \"{}\"; expected a frame's number, from 0 on", text);
  }
  return frame;
}

}  // namespace gicodec::tools
