// Counts what the whole process holds on the heap, third-party libraries included.
#pragma once

#include <cstddef>

namespace gicodec::test {

inline constexpr std::size_t kKiB = 1024, kMiB = 1024 * kKiB;

/// Bytes allocated now, plus a constant.
[[nodiscard]] std::size_t heap_bytes() noexcept;
/// The most that heap_bytes() was since the last call of start_peak().
[[nodiscard]] std::size_t heap_peak() noexcept;
void start_peak() noexcept;
/// All bytes that were ever allocated, and in how many pieces.
[[nodiscard]] std::size_t heap_total() noexcept;
[[nodiscard]] std::size_t heap_allocations() noexcept;

/// What `body` needs beyond what is there already.
template <typename Body>
[[nodiscard]] std::size_t heap_peak_of(Body&& body) {
  const std::size_t before = heap_bytes();
  start_peak();
  body();
  return heap_peak() - before;
}

}  // namespace gicodec::test
