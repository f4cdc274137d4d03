// Formats for tests that are slow with all of them.
#pragma once

#include <gicodec/record.h>

#include <algorithm>
#include <vector>

namespace gicodec::test {

/// Of formats that differ only in what their integers mean, the first: codecs treat them alike.
inline std::vector<FormatInfo> distinct_formats() {
  const auto alike = [](const FormatInfo& a, const FormatInfo& b) {
    const auto same = [](const Component& x, const Component& y) {
      const bool floats = x.type == ComponentType::sfloat || y.type == ComponentType::sfloat;
      return x.offset == y.offset && x.bits == y.bits && (!floats || x.type == y.type);
    };
    const auto left = a.record.used(), right = b.record.used();
    return a.record.bytes == b.record.bytes &&
           std::equal(left.begin(), left.end(), right.begin(), right.end(), same);
  };
  std::vector<FormatInfo> distinct;
  for (const FormatInfo& format : formats()) {
    const auto same = [&](const FormatInfo& other) { return alike(format, other); };
    const bool known = std::any_of(distinct.begin(), distinct.end(), same);
    if (!known) distinct.push_back(format);
  }
  return distinct;
}

}  // namespace gicodec::test
