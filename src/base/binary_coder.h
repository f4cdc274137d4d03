// Binary range coder: one bit at a time, each with a probability of its own (docs/native.md,
// "Binary coder"). Encoder and decoder offer the same calls, so that a model is written once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

inline constexpr unsigned kBitScale = 16;             ///< probabilities are of 2^16
inline constexpr std::uint32_t kMinRange = 1U << 24;  ///< below it a byte is output
inline constexpr unsigned kBinaryTail = 4;            ///< bytes that a code has
inline constexpr unsigned kMaxBypassBits = 8;         ///< of one step

class BinaryEncoder {
 public:
  static constexpr bool kDecodes = false;

  explicit BinaryEncoder(std::vector<std::byte>& out) noexcept : out_(out) {}

  /// `one`: the probability of a 1, from 1 to 65535. Returns the bit.
  bool bit(std::uint32_t one, bool bit) {
    const auto bound = static_cast<std::uint32_t>(std::uint64_t{range_} * one >> kBitScale);
    if (bit) {
      range_ = bound;
    } else {
      low_ += bound;
      range_ -= bound;
    }
    while (range_ < kMinRange) {
      range_ <<= 8;
      shift();
    }
    return bit;
  }
  /// Bypass bits: the low `count` bits of `value`, each 0 or 1 with equal probability; highest
  /// first.
  std::uint32_t bypass(unsigned count, std::uint32_t value) {
    for (unsigned left = count; left > 0;) {
      const unsigned step = left < kMaxBypassBits ? left : kMaxBypassBits;
      left -= step;
      range_ >>= step;
      low_ += std::uint64_t{range_} * (value >> left & ((1U << step) - 1));
      while (range_ < kMinRange) {
        range_ <<= 8;
        shift();
      }
    }
    return value;
  }
  /// Of the numbers that decode to the same, the one with the most zero bytes at its end, up to
  /// four: these are left out.
  void finish() {
    constexpr std::uint64_t kLast = kMinRange - 1, kAll = UINT32_MAX;
    const bool all = ((low_ + kAll) & ~kAll) < low_ + range_;
    low_ = all ? (low_ + kAll) & ~kAll : (low_ + kLast) & ~kLast;
    shift();
    if (!all) shift();
  }
  /// Of all bytes of the output so far.
  [[nodiscard]] std::size_t size() const noexcept { return out_.size(); }

 private:
  /// Outputs the highest byte; bytes of 255 are held back, since a carry may pass through them.
  void shift() {
    if (low_ < 0xFF000000U || low_ >> 32 != 0) {
      const auto carry = static_cast<unsigned>(low_ >> 32);
      // The first byte of all is 0 and is left out.
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

/// Safe on any bytes: after the last come zeros, up to four; overrun() is true after more.
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
    while (range_ < kMinRange) {
      range_ <<= 8;
      take();
    }
    return bit;
  }
  std::uint32_t bypass(unsigned count, std::uint32_t = 0) noexcept {
    std::uint32_t value = 0;
    for (unsigned left = count; left > 0;) {
      const unsigned step = left < kMaxBypassBits ? left : kMaxBypassBits;
      left -= step;
      range_ >>= step;
      // More only in damaged streams.
      std::uint32_t part = code_ / range_;
      if (part >> step != 0) part = (1U << step) - 1;
      code_ -= part * range_;
      value = value << step | part;
      while (range_ < kMinRange) {
        range_ <<= 8;
        take();
      }
    }
    return value;
  }
  /// More was read than there is.
  [[nodiscard]] bool overrun() const noexcept { return behind_ > kBinaryTail; }
  /// Everything was read, and ends as an encoder ends it.
  [[nodiscard]] bool ended() const noexcept {
    if (behind_ == kBinaryTail) return code_ < range_;
    if (next_ != end_ || behind_ != kBinaryTail - 1) return false;
    // Not the lowest number, or one with another zero byte would do.
    const auto last = std::to_integer<std::uint64_t>(end_[-1]);
    return code_ < kMinRange && last != 0 && code_ + (256 - last) * kMinRange >= range_;
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
  unsigned behind_ = 0;  ///< zeros read after the end, counted up to one too many
};

}  // namespace gicodec
