// Cursors over bytes: little-endian integers and LEB128 varints. A reader never reads past its end.
// After a failure it stays failed, and every further read gives zero.
#pragma once

#include <gicodec/status.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace gicodec {

static_assert(std::endian::native == std::endian::little, "texels and fields are little-endian");

inline constexpr std::size_t kMaxVarint = 10;

class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& out) noexcept : out_(out) {}

  template <typename T>
  void fixed(T value) {
    static_assert(std::is_unsigned_v<T>);
    bytes(std::as_bytes(std::span(&value, 1)));
  }
  void varint(std::uint64_t value) {
    while (value >= 0x80) {
      out_.push_back(static_cast<std::byte>(value | 0x80));
      value >>= 7;
    }
    out_.push_back(static_cast<std::byte>(value));
  }
  void bytes(std::span<const std::byte> bytes) {
    const std::size_t end = out_.size();
    out_.resize(end + bytes.size());
    if (!bytes.empty()) std::memcpy(out_.data() + end, bytes.data(), bytes.size());
  }
  /// Length as varint, then the bytes.
  void text(std::string_view text) {
    varint(text.size());
    bytes(std::as_bytes(std::span(text.data(), text.size())));
  }

 private:
  std::vector<std::byte>& out_;
};

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) noexcept : rest_(bytes) {}

  [[nodiscard]] bool ok() const noexcept { return status_ == Status::ok; }
  [[nodiscard]] Status status() const noexcept { return status_; }
  [[nodiscard]] std::span<const std::byte> rest() const noexcept { return rest_; }
  void fail(Status status) noexcept {
    if (ok()) status_ = status;
    rest_ = {};
  }

  template <typename T>
  T fixed() noexcept {
    static_assert(std::is_unsigned_v<T>);
    T value{};
    if (const auto from = bytes(sizeof value); !from.empty()) {
      std::memcpy(&value, from.data(), sizeof value);
    }
    return value;
  }
  /// A LEB128 value of at most `max`; corrupt if larger, or encoded longer than needed.
  std::uint64_t varint(std::uint64_t max = UINT64_MAX) noexcept {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const auto byte = fixed<std::uint8_t>();
      if (!ok()) return 0;
      const std::uint64_t part = byte & 0x7FU;
      if (part << shift >> shift != part || (byte == 0 && shift > 0)) break;
      value |= part << shift;
      if (byte < 0x80) {
        if (value > max) break;
        return value;
      }
    }
    fail(Status::corrupt);
    return 0;
  }
  /// The next `size` bytes; empty and failed if there are fewer.
  std::span<const std::byte> bytes(std::size_t size) noexcept {
    if (size > rest_.size()) {
      fail(Status::truncated);
      return {};
    }
    const auto taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }
  std::string_view text(std::size_t max_size) noexcept {
    const auto taken = bytes(static_cast<std::size_t>(varint(max_size)));
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }

 private:
  std::span<const std::byte> rest_;
  Status status_ = Status::ok;
};

}  // namespace gicodec
