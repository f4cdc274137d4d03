#include "stream/band_differences.h"

#include <cstdint>

namespace gicodec {

template <typename Coder>
std::byte BandDifferences::code(Coder& coder, ByteModel& model, bool zero_before, std::byte byte) {
  if (model.zero[zero_before ? 1 : 0].code(coder, byte == std::byte{0})) return std::byte{0};
  const auto value = std::to_integer<std::uint32_t>(byte);
  std::uint32_t node = 1;
  for (unsigned left = 8; left-- > 0;) {
    node = node << 1 | (model.node[node].code(coder, (value >> left & 1) != 0) ? 1U : 0U);
  }
  return static_cast<std::byte>(node & 255);
}

template <typename Body>
void BandDifferences::for_each_byte(std::span<const std::byte> bytes, std::size_t record,
                                    const Body& body) {
  models_.assign(record, {});
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    body(models_[i % record], i < record || bytes[i - record] == std::byte{0}, i);
  }
}

void BandDifferences::encode(std::span<const std::byte> bytes, std::size_t record,
                             std::vector<std::byte>& out) {
  BinaryEncoder coder(out);
  for_each_byte(bytes, record, [&](ByteModel& model, bool zero_before, std::size_t i) {
    code(coder, model, zero_before, bytes[i]);
  });
  coder.finish();
}

Status BandDifferences::decode(std::span<const std::byte> from, std::size_t record,
                               std::span<std::byte> bytes) {
  BinaryDecoder coder(from);
  for_each_byte(bytes, record, [&](ByteModel& model, bool zero_before, std::size_t i) {
    if (!coder.overrun()) bytes[i] = code(coder, model, zero_before, std::byte{0});
  });
  if (coder.overrun()) return Status::truncated;
  return coder.ended() ? Status::ok : Status::corrupt;
}

std::size_t BandDifferences::most(std::size_t code) noexcept {
  // A bit costs 1/45 bits or more, the end up to four bytes less than it has.
  constexpr std::size_t kMostOfByte = 360, kTail = 4;
  return (code + kTail) * kMostOfByte;
}

}  // namespace gicodec
