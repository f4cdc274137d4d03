// What the instruction sets implement: residuals of a block's planes ↔ tokens and raw bits.
#pragma once

#include "native/tokens/token_groups.h"
#include "simd/dispatch.h"

#include <cstddef>
#include <cstdint>

namespace gicodec::native {

/// Bits written one behind the other, lowest first.
struct BitSink {
  std::uint8_t* next;
  std::uint64_t bits;
  unsigned count;
};
/// Bits to read, from a number of them on. The bytes have kRawSlack more behind a block's.
struct BitSource {
  const std::uint8_t* bytes;
  std::uint64_t at;
};
/// Bytes that a texel's raw bits may take, at most, and those that are read beyond.
inline constexpr std::size_t kMaxRawBytes = 4, kRawSlack = 16;

/// Planes of a group in one block. Arrays have room for whole vectors behind the texels.
struct TokenBlock {
  const std::uint16_t* current[kMaxGroupPlanes];  ///< decoding writes them
  const std::uint16_t* reference[kMaxGroupPlanes];
  const std::uint16_t* copy[kCopies][kMaxGroupPlanes];  ///< of X, Z, Y; if the group copies
  /// The row of differences above the first, `width` of them; null: zeros.
  const std::uint16_t* before[kMaxGroupPlanes];
  /// By texel: all bits set in the first 1, 2, 4, … columns; arrays of `stride`, as many as halve
  /// the width.
  const std::uint16_t* columns;
  unsigned texels, width;
  std::size_t stride;
  std::uint16_t* scratch;  ///< token_scratch() values
};
/// A value that is not used, then differences, residuals and copies of a group, each with a row
/// before it.
constexpr std::size_t token_scratch(std::size_t width, std::size_t stride) {
  return 1 + (width + stride) * (3 * kMaxGroupPlanes + 2);
}

struct TokenKernels {
  /// Tokens of a block, and raw bits behind those of blocks before it.
  void (*write)(const TokenGroup&, const TokenBlock&, std::uint8_t* tokens, BitSink&);
  /// The inverse: values of the planes.
  void (*read)(const TokenGroup&, const TokenBlock&, const std::uint8_t* tokens, BitSource&,
               std::uint16_t* const* planes);
};

}  // namespace gicodec::native
