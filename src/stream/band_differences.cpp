#include "stream/band_differences.h"

#include "base/learned_bit.h"

#include <gicodec/record.h>

#include <array>
#include <cstdint>

namespace gicodec {
namespace {

/// Of one byte of records: whether it is zero, by whether that of the record before was; then its
/// bits, by those before.
struct ByteModel {
  std::array<LearnedBit, 2> zero;
  std::array<LearnedBit, 256> node;
};

template <typename Coder>
std::byte code_byte(Coder& coder, ByteModel& model, bool zero_before, std::byte byte) {
  if (model.zero[zero_before ? 1 : 0].code(coder, byte == std::byte{0})) return std::byte{0};
  const auto value = std::to_integer<std::uint32_t>(byte);
  std::uint32_t node = 1;
  for (unsigned left = 8; left-- > 0;) {
    node = node << 1 | (model.node[node].code(coder, (value >> left & 1) != 0) ? 1U : 0U);
  }
  return static_cast<std::byte>(node & 255);
}

/// Calls body(model, whether the byte of the record before was zero, place) for every byte.
template <typename Body>
void for_each_byte(std::span<const std::byte> bytes, std::size_t record, const Body& body) {
  Vector<ByteModel> models(record);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    body(models[i % record], i < record || bytes[i - record] == std::byte{0}, i);
  }
}

}  // namespace

void encode_differences(std::span<const std::byte> bytes, std::size_t record,
                        std::vector<std::byte>& out) {
  BinaryEncoder coder(out);
  for_each_byte(bytes, record, [&](ByteModel& model, bool zero_before, std::size_t i) {
    code_byte(coder, model, zero_before, bytes[i]);
  });
  coder.finish();
}

std::size_t most_differences(std::size_t code) noexcept {
  // A bit costs 1/45 bits or more, the end up to four bytes less than it has.
  constexpr std::size_t kMostOfByte = 360, kTail = 4;
  return (code + kTail) * kMostOfByte;
}

Status decode_differences(std::span<const std::byte> code, std::size_t record,
                          std::span<std::byte> bytes) {
  BinaryDecoder coder(code);
  for_each_byte(bytes, record, [&](ByteModel& model, bool zero_before, std::size_t i) {
    if (!coder.overrun()) bytes[i] = code_byte(coder, model, zero_before, std::byte{0});
  });
  if (coder.overrun()) return Status::truncated;
  return coder.ended() ? Status::ok : Status::corrupt;
}

}  // namespace gicodec
