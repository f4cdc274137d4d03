// Reads bits of an HEVC raw byte sequence payload: most significant bit first, without emulation
// prevention bytes, with Exp-Golomb codes (ITU-T H.265 7.3.1, 9.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::hevc {

/// After a failure every read gives zero and ok() stays false.
class SyntaxReader {
 public:
  explicit SyntaxReader(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

  [[nodiscard]] bool ok() const noexcept { return ok_; }
  void require(bool condition) noexcept { ok_ = ok_ && condition; }

  bool flag() noexcept {
    if (left_ == 0) next_byte();
    if (!ok_) return false;
    --left_;
    return ((current_ >> left_) & 1U) != 0;
  }
  /// count ≤ 32.
  std::uint32_t bits(unsigned count) noexcept {
    std::uint32_t value = 0;
    for (; count > 0; --count) value = value << 1 | static_cast<std::uint32_t>(flag());
    return value;
  }
  void skip(unsigned count) noexcept {
    for (; count > 0; --count) flag();
  }
  /// ue(v) of at most `max`, itself below 2³² − 1.
  std::uint32_t ue(std::uint32_t max = UINT32_MAX - 1) noexcept {
    unsigned zeros = 0;
    while (ok_ && !flag()) require(++zeros < 32);
    const std::uint64_t value = (std::uint64_t{1} << zeros) - 1 + bits(zeros);
    require(value <= max);
    return ok_ ? static_cast<std::uint32_t>(value) : 0;
  }
  /// se(v) from −limit to limit.
  std::int32_t se(std::int32_t limit) noexcept {
    const std::uint32_t code = ue(2 * static_cast<std::uint32_t>(limit));
    const auto magnitude = static_cast<std::int32_t>((code + 1) / 2);
    return code % 2 == 1 ? magnitude : -magnitude;
  }
  /// rbsp_trailing_bits(): a one, zeros to the end of the byte, then nothing.
  void trailing_bits() noexcept {
    require(flag());
    while (ok_ && left_ > 0) require(!flag());
    require(position_ == bytes_.size());
  }

 private:
  void next_byte() noexcept {
    if (zeros_ == 2 && position_ < bytes_.size() && bytes_[position_] == std::byte{3}) {
      ++position_;
      zeros_ = 0;
    }
    require(position_ < bytes_.size());
    if (!ok_) return;
    current_ = std::to_integer<unsigned>(bytes_[position_++]);
    zeros_ = current_ == 0 ? zeros_ + 1 : 0;
    left_ = 8;
  }

  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  unsigned current_ = 0, left_ = 0, zeros_ = 0;
  bool ok_ = true;
};

}  // namespace gicodec::hevc
