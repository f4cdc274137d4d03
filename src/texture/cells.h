// Cells of a scrolling volume, and the places of their blocks in the texture.
#pragma once

#include <gicodec/volume.h>

#include <array>
#include <cmath>
#include <cstdint>

namespace gicodec {

inline std::array<std::uint32_t, 3> sides(Grid grid) { return {grid.x, grid.y, grid.z}; }

/// c mod n, never negative.
inline std::uint32_t wrap(std::int64_t cell, std::uint32_t blocks) {
  const auto n = static_cast<std::int64_t>(blocks);
  return static_cast<std::uint32_t>((cell % n + n) % n);
}

/// The cell, scroll..scroll + n − 1, whose block stands at `place`.
inline std::int64_t cell_at(std::uint32_t place, std::int32_t scroll, std::uint32_t blocks) {
  return scroll + std::int64_t{wrap(std::int64_t{place} - scroll, blocks)};
}

inline bool finite(const Position& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

}  // namespace gicodec
