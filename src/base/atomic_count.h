// Counters in a growing array that threads share for a while: std::atomic_ref, which not every
// standard library has.
#pragma once

#include <cstdint>

namespace gicodec {

inline void add(std::uint32_t& count) noexcept { __atomic_fetch_add(&count, 1, __ATOMIC_RELAXED); }
inline void subtract(std::uint32_t& count) noexcept {
  __atomic_fetch_sub(&count, 1, __ATOMIC_ACQ_REL);
}

}  // namespace gicodec
