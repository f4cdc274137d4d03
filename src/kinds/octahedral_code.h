// Octahedral codes of directions, shared by kinds. All arithmetic is in binary64.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace gicodec {

struct Octahedral {
  std::int32_t u = 0, v = 0;
};

namespace octahedral {

inline double sign(double value) noexcept { return value < 0 ? -1 : 1; }

/// Folds the lower half (z negative) over the square's corners; its own inverse.
inline void fold(double& x, double& y) noexcept {
  const double folded = (1 - std::abs(y)) * sign(x);
  y = (1 - std::abs(x)) * sign(y);
  x = folded;
}

/// The unit vector of a code with -most..most along each axis; lower codes count as -most.
[[nodiscard]] inline std::array<double, 3> direction(Octahedral code, std::int32_t most) noexcept {
  double x = static_cast<double>(std::max(code.u, -most)) / most;
  double y = static_cast<double>(std::max(code.v, -most)) / most;
  const double z = 1 - std::abs(x) - std::abs(y);
  if (z < 0) fold(x, y);
  const double size = std::sqrt(x * x + y * y + z * z);
  return {x / size, y / size, z / size};
}

/// Picks one of the two codes of a direction on the rim, (u, ±most) and (−u, ±most), likewise for
/// v: the one whose other axis is not negative.
[[nodiscard]] inline Octahedral unique(Octahedral code, std::int32_t most) noexcept {
  if (std::abs(code.u) == most) code.v = std::abs(code.v);
  if (std::abs(code.v) == most) code.u = std::abs(code.u);
  return code;
}

}  // namespace octahedral
}  // namespace gicodec
