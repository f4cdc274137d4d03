// Binary range coder: codes one bit at a time, each with its own probability (docs/native.md,
// "Binary coder"). Encoder and decoder have the same calls, so that a model is written once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

inline constexpr unsigned kBitScale = 16;               ///< probabilities are in 1/2^16
inline constexpr std::uint32_t kLeastRange = 1U << 24;  ///< below it, the coder shifts out a byte
inline constexpr unsigned kBinaryTail = 4;              ///< bytes of a code value
inline constexpr unsigned kMaxPlainBits = 8;            ///< bypass bits per step

class BinaryEncoder {
 public:
  static constexpr bool kDecodes = false;

  explicit BinaryEncoder(std::vector<std::byte>& out) noexcept : out_(out) {}

  /// `one`: the probability that the bit is 1, 1..65535. Returns the bit.
  bool bit(std::uint32_t one, bool bit) {
    const auto bound = static_cast<std::uint32_t>(std::uint64_t{range_} * one >> kBitScale);
    if (bit) {
      range_ = bound;
    } else {
      low_ += bound;
      range_ -= bound;
    }
    while (range_ < kLeastRange) {
      range_ <<= 8;
      shift();
    }
    return bit;
  }
  /// Bypass: the low `count` bits of `value` with probability 1/2 each, highest first.
  std::uint32_t plain(unsigned count, std::uint32_t value) {
    for (unsigned left = count; left > 0;) {
      const unsigned step = left < kMaxPlainBits ? left : kMaxPlainBits;
      left -= step;
      range_ >>= step;
      low_ += std::uint64_t{range_} * (value >> left & ((1U << step) - 1));
      while (range_ < kLeastRange) {
        range_ <<= 8;
        shift();
      }
    }
    return value;
  }
  /// Of the code values that decode to the same bits, writes the one with the most zero bytes at
  /// its end, up to four, and drops these.
  void finish() {
    constexpr std::uint64_t kLast = kLeastRange - 1, kAll = UINT32_MAX;
    const bool all = ((low_ + kAll) & ~kAll) < low_ + range_;
    low_ = all ? (low_ + kAll) & ~kAll : (low_ + kLast) & ~kLast;
    shift();
    if (!all) shift();
  }
  /// Bytes of the output so far.
  [[nodiscard]] std::size_t size() const noexcept { return out_.size(); }

 private:
  /// Shifts out the highest byte. Bytes of 255 wait, since a carry may still pass through them.
  void shift() {
    if (low_ < 0xFF000000U || low_ >> 32 != 0) {
      const auto carry = static_cast<unsigned>(low_ >> 32);
      // The very first byte is 0 and is dropped.
      if (begun_) out_.push_back(static_cast<std::byte>(held_ + carry));
      for (; waiting_ > 0; --waiting_) out_.push_back(static_cast<std::byte>(255 + carry));
      begun_ = true;
      held_ = static_cast<std::uint8_t>(low_ >> 24);
    } else {
      ++waiting_;
    }
    low_ = (low_ & 0x00FFFFFFU) << 8;
  }

  std::vector<std::byte>& out_;
  std::uint64_t low_ = 0;
  std::uint32_t range_ = UINT32_MAX;
  std::size_t waiting_ = 0;
  std::uint8_t held_ = 0;
  bool begun_ = false;
};

/// Safe on hostile bytes. Behind the last byte it reads zeros, up to four; overrun() reports more.
class BinaryDecoder {
 public:
  static constexpr bool kDecodes = true;

  explicit BinaryDecoder(std::span<const std::byte> bytes) noexcept
      : next_(bytes.data()), end_(bytes.data() + bytes.size()) {
    for (unsigned i = 0; i < kBinaryTail; ++i) take();
  }

  bool bit(std::uint32_t one, bool = false) noexcept {
    const auto bound = static_cast<std::uint32_t>(std::uint64_t{range_} * one >> kBitScale);
    const bool bit = code_ < bound;
    if (bit) {
      range_ = bound;
    } else {
      code_ -= bound;
      range_ -= bound;
    }
    while (range_ < kLeastRange) {
      range_ <<= 8;
      take();
    }
    return bit;
  }
  std::uint32_t plain(unsigned count, std::uint32_t = 0) noexcept {
    std::uint32_t value = 0;
    for (unsigned left = count; left > 0;) {
      const unsigned step = left < kMaxPlainBits ? left : kMaxPlainBits;
      left -= step;
      range_ >>= step;
      // Only damaged streams exceed `step` bits.
      std::uint32_t part = code_ / range_;
      if (part >> step != 0) part = (1U << step) - 1;
      code_ -= part * range_;
      value = value << step | part;
      while (range_ < kLeastRange) {
        range_ <<= 8;
        take();
      }
    }
    return value;
  }
  /// True if more was read than the input has.
  [[nodiscard]] bool overrun() const noexcept { return behind_ > kBinaryTail; }
  /// True if all input was read, and it ends as an encoder ends it.
  [[nodiscard]] bool ended() const noexcept {
    if (behind_ == kBinaryTail) return code_ < range_;
    if (next_ != end_ || behind_ != kBinaryTail - 1) return false;
    // The encoder would have dropped this byte if a value with another zero byte existed.
    const auto last = std::to_integer<std::uint64_t>(end_[-1]);
    return code_ < kLeastRange && last != 0 && code_ + (256 - last) * kLeastRange >= range_;
  }

 private:
  void take() noexcept {
    std::uint32_t byte = 0;
    if (next_ != end_) {
      byte = std::to_integer<std::uint32_t>(*next_++);
    } else if (behind_ <= kBinaryTail) {
      ++behind_;
    }
    code_ = code_ << 8 | byte;
  }

  const std::byte* next_;
  const std::byte* end_;
  std::uint32_t code_ = 0, range_ = UINT32_MAX;
  unsigned behind_ = 0;  ///< zeros read behind the end, at most kBinaryTail + 1
};

}  // namespace gicodec
