// Hands the newest value from one thread to another; neither ever waits.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace gicodec {

/// The writer fills back() and publishes it; the reader takes the newest published value. A third
/// slot lies between the two.
template <typename T>
class TripleBuffer {
 public:
  /// Writer: holds some value published earlier, or T().
  [[nodiscard]] T& back() noexcept { return slots_[back_]; }
  void publish() noexcept {
    const std::uint8_t before = middle_.exchange(back_ | kNew, std::memory_order_acq_rel);
    back_ = before & kSlot;
  }
  /// Reader: valid until the next call.
  [[nodiscard]] const T& latest() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kNew) != 0) {
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kSlot;
    }
    return slots_[front_];
  }

 private:
  static constexpr std::uint8_t kSlot = 3, kNew = 4;

  std::array<T, 3> slots_{};
  std::uint8_t back_ = 0;   // Writer's.
  std::uint8_t front_ = 1;  // Reader's.
  std::atomic<std::uint8_t> middle_{2};
};

}  // namespace gicodec
