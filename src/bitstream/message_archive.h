// Fields of messages: a Writer and a Reader with the same calls, so that messages list fields once.
#pragma once

#include <gicodec/protocol.h>

#include "base/bytes.h"
#include "base/text.h"
#include "bitstream/index_buffer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace gicodec {

constexpr std::uint64_t kMaxBytes = std::numeric_limits<std::uint32_t>::max();

class Writer {
 public:
  explicit Writer(Message& out) : writer_(out) {}

  template <typename T>
  void number(const T& value, std::uint64_t max = std::numeric_limits<T>::max()) {
    check(value <= max);
    writer_.varint(value);
  }
  template <typename T>
  void fixed(const T& value) {
    writer_.fixed(value);
  }
  void raw(std::span<const std::byte> value) { writer_.bytes(value); }
  void signed_number(const std::int32_t& value) {
    writer_.varint(static_cast<std::uint32_t>(value) << 1 ^
                   static_cast<std::uint32_t>(value >> 31));
  }
  template <typename Float>
  void real(const Float& value) {
    check(std::isfinite(value)), raw(std::as_bytes(std::span(&value, 1)));
  }
  void text(const std::string& value, std::size_t max) {
    check(is_utf8(value)), secret(value, max);
  }
  /// Any bytes, at most `max`.
  void secret(const std::string& value, std::size_t max) {
    check(value.size() <= max), writer_.text(value);
  }
  void bytes(const std::span<const std::byte>& value) {
    writer_.varint(value.size()), writer_.bytes(value);
  }
  void block(const std::vector<std::byte>& value, std::size_t max) {
    check(value.size() <= max), bytes(value);
  }
  /// 0 or more; infinity: unknown.
  void largest_error(const float& value) {
    check(value >= 0), raw(std::as_bytes(std::span(&value, 1)));
  }
  template <typename T>
  void count(const std::vector<T>& list, std::size_t max, std::size_t) {
    check(list.size() <= max);
    writer_.varint(list.size());
  }
  /// Ascending blocks below `total`.
  void blocks(std::span<const std::uint32_t> list, std::uint32_t total) {
    Message index;
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (list[i] >= total || (i > 0 && list[i] <= list[i - 1])) return check(false);
    }
    const IndexMode mode = encode_index_buffer(list, total, index);
    fixed(static_cast<std::uint8_t>(mode));
    if (mode == IndexMode::all) return;
    writer_.varint(list.size());
    bytes(index);
  }
  void check(bool good) { good_ = good_ && good; }
  [[nodiscard]] Status status() const { return good_ ? Status::ok : Status::invalid_argument; }

 private:
  ByteWriter writer_;
  bool good_ = true;
};

class Reader {
 public:
  Reader(std::span<const std::byte> bytes, const MessageLimits& limits)
      : reader_(bytes), limits_(limits) {}

  template <typename T>
  void number(T& value, std::uint64_t max = std::numeric_limits<T>::max()) {
    value = static_cast<T>(reader_.varint(max));
  }
  template <typename T>
  void fixed(T& value) {
    value = reader_.fixed<T>();
  }
  void raw(std::span<std::byte> value) {
    const auto from = reader_.bytes(value.size());
    std::copy(from.begin(), from.end(), value.begin());
  }
  void signed_number(std::int32_t& value) {
    const auto folded =
        static_cast<std::uint32_t>(reader_.varint(std::numeric_limits<std::uint32_t>::max()));
    value = static_cast<std::int32_t>(folded >> 1 ^ (~(folded & 1) + 1));
  }
  template <typename Float>
  void real(Float& value) {
    raw(std::as_writable_bytes(std::span(&value, 1)));
    check(std::isfinite(value));
  }
  void text(std::string& value, std::size_t max) { secret(value, max), check(is_utf8(value)); }
  void secret(std::string& value, std::size_t max) { value = reader_.text(max); }
  void bytes(std::span<const std::byte>& value) {
    value = reader_.bytes(static_cast<std::size_t>(reader_.varint(kMaxBytes)));
  }
  void block(std::vector<std::byte>& value, std::size_t max) {
    std::span<const std::byte> found;
    bytes(found);
    check(found.size() <= max);
    if (reader_.ok()) value.assign(found.begin(), found.end());
  }
  void largest_error(float& value) {
    raw(std::as_writable_bytes(std::span(&value, 1)));
    check(value >= 0);
  }
  /// Length of a list whose items take `item` bytes or more each, so that allocations are bounded
  /// by received bytes.
  template <typename T>
  void count(std::vector<T>& list, std::size_t max, std::size_t item) {
    const auto size = static_cast<std::size_t>(reader_.varint(max));
    if (size > reader_.rest().size() / item) reader_.fail(Status::truncated);
    if (reader_.ok()) list.resize(size);
  }
  void blocks(Vector<std::uint32_t>& list, std::uint32_t total) {
    if (total > limits_.max_blocks) reader_.fail(Status::limit_exceeded);
    std::uint8_t mode = 0;
    fixed(mode);
    check(mode <= static_cast<std::uint8_t>(IndexMode::runs));
    std::uint32_t count = total;
    std::span<const std::byte> index;
    if (mode != static_cast<std::uint8_t>(IndexMode::all)) {
      number(count, total);
      bytes(index);
    }
    if (!reader_.ok()) return;
    const Status status =
        decode_index_buffer(static_cast<IndexMode>(mode), count, total, index, list);
    if (status != Status::ok) reader_.fail(status);
  }
  void check(bool good) {
    if (!good) reader_.fail(Status::corrupt);
  }
  void fail(Status status) { reader_.fail(status); }
  [[nodiscard]] bool at_end() const { return reader_.rest().empty(); }
  [[nodiscard]] Status status() const { return reader_.status(); }

 private:
  ByteReader reader_;
  const MessageLimits& limits_;
};

}  // namespace gicodec
