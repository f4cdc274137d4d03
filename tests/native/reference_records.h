// Records of adaptive chunks for the reference decoder (docs/native/records.md).
#pragma once

#include "native/reference_adaptive.h"
#include "native/reference_bits.h"

#include <algorithm>
#include <vector>

namespace gicodec::reference {

using Components = std::vector<Number>;  ///< values of a record

[[nodiscard]] inline Number mask_of(unsigned bits) { return (Number{1} << bits) - 1; }
[[nodiscard]] inline Number top_of(Number value, unsigned bits, unsigned n = 8) {
  return bits > n ? value >> (bits - n) : value;
}
[[nodiscard]] inline Number with_sign(Number value, unsigned bits) {
  value &= mask_of(bits);
  return value >> (bits - 1) != 0 ? value - (Number{1} << bits) : value;
}
[[nodiscard]] std::vector<std::byte> packed(const Record& record,
                                            const std::vector<Components>& records);
[[nodiscard]] Components unpacked(const Record& record, const std::byte* bytes);

// Arithmetic of the models of records and vectors.
inline constexpr Number kMax = Number{1} << 41;
[[nodiscard]] inline Number prop(Number v, Number t, Number f) {
  const unsigned s = width_of(f) > 16 ? width_of(f) - 16 : 0;
  return std::min(v * std::min<Number>(t >> s, (1 << 20) - 1) / (f >> s), kMax);
}
[[nodiscard]] inline Number half(Number x) {
  if (x < 0) x = -x;
  const unsigned w = width_of(x);
  return w < 3 ? x : 2 * w + (x >> (w - 2)) % 2;
}
[[nodiscard]] inline Number sign(Number x) { return x < 0 ? 0 : x == 0 ? 1 : 2; }

/// The blocks' records by the record model.
[[nodiscard]] std::vector<std::vector<std::byte>> decode_records(
    const TextureDesc& desc, const std::vector<AdaptiveBlock>& blocks, BitModels& models);

}  // namespace gicodec::reference
