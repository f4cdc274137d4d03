// Percentiles of measured values.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace gicodec::streaming {

/// The 50th, 95th and 99th percentile; 0 of nothing.
[[nodiscard]] inline std::array<float, 3> percentiles(std::vector<float> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](std::size_t percent) {
    return values[std::min(values.size() - 1, values.size() * percent / 100)];
  };
  return {at(50), at(95), at(99)};
}

}  // namespace gicodec::streaming
