// Records of adaptive chunks for the reference decoder (docs/native.md, section 9.4).
#pragma once

#include "native/reference_adaptive.h"
#include "native/reference_bits.h"

#include <vector>

namespace gicodec::reference {

using Components = std::vector<Number>;  ///< values of a record

[[nodiscard]] inline Number mask_of(unsigned bits) { return (Number{1} << bits) - 1; }
[[nodiscard]] inline Number top_of(Number value, unsigned bits) {
  return bits > 8 ? value >> (bits - 8) : value;
}
[[nodiscard]] inline Number with_sign(Number value, unsigned bits) {
  value &= mask_of(bits);
  return value >> (bits - 1) != 0 ? value - (Number{1} << bits) : value;
}
[[nodiscard]] std::vector<std::byte> packed(const Record& record,
                                            const std::vector<Components>& records);
[[nodiscard]] Components unpacked(const Record& record, const std::byte* bytes);

/// The blocks' records by the record model.
[[nodiscard]] std::vector<std::vector<std::byte>> decode_records(
    const TextureDesc& desc, const std::vector<AdaptiveBlock>& blocks, Learner& learner);

}  // namespace gicodec::reference
