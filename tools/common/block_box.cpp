#include "block_box.h"

#include "dump/error.h"

#include <charconv>
#include <cstddef>

namespace gicodec::tools {

BlockBox box_from_flag(const char* flag, const std::string& text, const char* other) {
  BlockBox box;
  const char* at = text.data();
  const char* const end = at + text.size();
  bool good = true;
  const auto number = [&](std::uint32_t& value, char before) {
    if (before != 0 && (at == end || *at++ != before)) return good = false;
    const auto parsed = std::from_chars(at, end, value);
    at = parsed.ptr;
    return good = good && parsed.ec == std::errc{};
  };
  for (std::size_t axis = 0; good && axis < 3; ++axis) {
    good = number(box.first[axis], axis == 0 ? '\0' : ',') && number(box.last[axis], '-') &&
           box.first[axis] <= box.last[axis];
  }
  if (!good || at != end) {
    fail(Exit::usage, "{}: expected {}a box such as 0-7,0-3,4-11, not \"{}\"", flag, other, text);
  }
  return box;
}

}  // namespace gicodec::tools
