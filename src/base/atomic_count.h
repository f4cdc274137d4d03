// Atomic operations on plain counters, for arrays that must grow. std::atomic_ref is missing in
// some standard libraries.
#pragma once

#include <cstdint>

namespace gicodec {

inline void add(std::uint32_t& count) noexcept { __atomic_fetch_add(&count, 1, __ATOMIC_RELAXED); }
inline void subtract(std::uint32_t& count) noexcept {
  __atomic_fetch_sub(&count, 1, __ATOMIC_ACQ_REL);
}

}  // namespace gicodec
