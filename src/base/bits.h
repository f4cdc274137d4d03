// Bit cursors, least significant bit of a byte first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

class BitWriter {
 public:
  explicit BitWriter(std::vector<std::byte>& out) noexcept : out_(out) {}

  /// The low `count` bits of `value`; count ≤ 32.
  void bits(std::uint32_t value, unsigned count) {
    const std::uint64_t mask = (std::uint64_t{1} << count) - 1;
    pending_ |= (value & mask) << used_;
    used_ += count;
    for (; used_ >= 8; used_ -= 8) {
      out_.push_back(static_cast<std::byte>(pending_));
      pending_ >>= 8;
    }
  }
  /// Pads the last byte with zeros.
  void finish() {
    if (used_ > 0) out_.push_back(static_cast<std::byte>(pending_));
    pending_ = 0;
    used_ = 0;
  }

 private:
  std::vector<std::byte>& out_;
  std::uint64_t pending_ = 0;
  unsigned used_ = 0;
};

/// Past the end every bit is zero and overrun() is true.
class BitReader {
 public:
  explicit BitReader(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

  /// count ≤ 32.
  std::uint32_t bits(unsigned count) noexcept {
    while (used_ < count) {
      std::uint64_t next = 0;
      if (position_ < bytes_.size()) {
        next = std::to_integer<std::uint64_t>(bytes_[position_++]);
      } else {
        overrun_ = true;
      }
      pending_ |= next << used_;
      used_ += 8;
    }
    const auto value = static_cast<std::uint32_t>(pending_ & ((std::uint64_t{1} << count) - 1));
    pending_ >>= count;
    used_ -= count;
    return value;
  }
  [[nodiscard]] bool overrun() const noexcept { return overrun_; }
  /// True if the bits left in the last byte read are all zero.
  [[nodiscard]] bool padding_is_zero() const noexcept { return pending_ == 0; }
  /// Whole bytes consumed so far.
  [[nodiscard]] std::size_t consumed() const noexcept { return position_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  std::uint64_t pending_ = 0;
  unsigned used_ = 0;
  bool overrun_ = false;
};

}  // namespace gicodec
