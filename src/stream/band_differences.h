// Differences of guard bands by the binary coder (FORMAT.md, "Guard band section").
#pragma once

#include "base/learned_bit.h"
#include "base/memory.h"

#include <gicodec/status.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace gicodec {

/// Memory of one thread, kept for its capacity.
class BandDifferences {
 public:
  /// Appends the bytes' code. `record`: bytes of a record, which bytes resemble by their place in
  /// it.
  void encode(std::span<const std::byte> bytes, std::size_t record, std::vector<std::byte>& out);
  /// The inverse: fills `bytes`.
  Status decode(std::span<const std::byte> code, std::size_t record, std::span<std::byte> bytes);
  /// The most bytes that so many bytes of code stand for.
  [[nodiscard]] static std::size_t most(std::size_t code) noexcept;

 private:
  /// Of one byte of records: whether it is zero, by whether that of the record before was; then its
  /// bits, by those before.
  struct ByteModel {
    std::array<LearnedBit, 2> zero;
    std::array<LearnedBit, 256> node;
  };
  template <typename Coder>
  static std::byte code(Coder& coder, ByteModel& model, bool zero_before, std::byte byte);
  /// Calls body(model, whether the byte of the record before was zero, place) for every byte.
  template <typename Body>
  void for_each_byte(std::span<const std::byte> bytes, std::size_t record, const Body& body);

  Vector<ByteModel> models_;
};

}  // namespace gicodec
