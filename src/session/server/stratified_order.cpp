#include "session/server/stratified_order.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gicodec {
namespace {

/// Splitmix64.
std::uint64_t next_random(std::uint64_t& state) {
  std::uint64_t z = state += 0x9E3779B97F4A7C15ULL;
  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ z >> 27) * 0x94D049BB133111EBULL;
  return z ^ z >> 31;
}

/// The last of the longest axes.
unsigned longest(const Grid& grid) {
  if (grid.z >= grid.x && grid.z >= grid.y) return 2;
  return grid.y >= grid.x ? 1 : 0;
}

}  // namespace

std::vector<std::uint32_t> stratified_order(const Grid& grid) {
  const std::array<std::uint32_t, 3> size{grid.x, grid.y, grid.z};
  const unsigned axis = longest(grid);
  std::vector<std::uint32_t> order(std::size_t{grid.x} * grid.y * grid.z);
  std::vector<std::vector<std::uint32_t>> slices(size[axis]);
  std::uint32_t vertex = 0, place = 0;
  std::array<std::uint32_t, 3> at{};
  for (at[2] = 0; at[2] < size[2]; ++at[2]) {
    for (at[1] = 0; at[1] < size[1]; ++at[1]) {
      for (at[0] = 0; at[0] < size[0]; ++at[0], ++vertex) {
        bool corner = true;
        for (unsigned a = 0; a < 3; ++a) corner = corner && (at[a] == 0 || at[a] + 1 == size[a]);
        if (corner) {
          order[vertex] = place++;
        } else {
          slices[at[axis]].push_back(vertex);
        }
      }
    }
  }
  std::uint64_t random = 0;
  std::size_t most = 0;
  for (auto& slice : slices) {
    for (std::size_t i = slice.size(); i > 1; --i)
      std::swap(slice[i - 1], slice[next_random(random) % i]);
    most = std::max(most, slice.size());
  }
  for (std::size_t i = 0; i < most; ++i) {
    for (const auto& slice : slices) {
      if (i < slice.size()) order[slice[i]] = place++;
    }
  }
  return order;
}

}  // namespace gicodec
