// The core texel that each texel of a guard band copies. The octahedral map's edges fold onto
// themselves: a row or column of the guard band is its neighbour mirrored, a corner the opposite
// one.
#pragma once

namespace gicodec {

/// copy(block row, block column, core row, core column) for every texel of the guard band of an n×n
/// block, in band order (guard_band.h).
template <typename Copy>
inline void walk_rule(unsigned n, Copy&& copy) {
  const unsigned last = n - 1;
  copy(0U, 0U, last, last);
  for (unsigned j = 0; j < n; ++j) copy(0U, j + 1, 0U, last - j);
  copy(0U, n + 1, last, 0U);
  for (unsigned j = 0; j < n; ++j) {
    copy(j + 1, 0U, last - j, 0U);
    copy(j + 1, n + 1, last - j, last);
  }
  copy(n + 1, 0U, 0U, last);
  for (unsigned j = 0; j < n; ++j) copy(n + 1, j + 1, last, last - j);
  copy(n + 1, n + 1, 0U, 0U);
}

}  // namespace gicodec
