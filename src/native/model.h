// The normative constants of the native bitstream's models: symbols, modes, contexts
// (docs/native.md).
#pragma once

#include "simd/vector.h"

#include <bit>
#include <cstddef>
#include <cstdint>

namespace gicodec::native {

inline constexpr std::uint8_t kVersion = 1;
using gicodec::kLanes;
inline constexpr unsigned kModes = 8;
inline constexpr unsigned kMaxPlanes = 8;

// Entropy coder: 32-bit states in [kStateLow, kStateLow << 16), 16-bit words.
inline constexpr unsigned kProbabilityBits = 12;
inline constexpr std::uint32_t kProbabilityScale = 1U << kProbabilityBits;
using gicodec::kStateLow;

// Tokens: a value below kDirect is its own token; a larger one is its bit length and the bit below
// the leading one, then the rest as raw bits.
inline constexpr unsigned kDirect = 16;
inline constexpr unsigned kTokens = 40;

constexpr unsigned token_of(std::uint16_t value) {
  if (value < kDirect) return value;
  const auto top = static_cast<unsigned>(std::bit_width(value)) - 1;
  return kDirect + 2 * (top - 4) + (value >> (top - 1) & 1U);
}

constexpr unsigned raw_bits_of(unsigned token) {
  return token < kDirect ? 0 : 3 + (token - kDirect) / 2;
}

// Context rows: 5 sign classes × kMagnitudes, padded to kRowSize.
inline constexpr unsigned kMagnitudes = 24;
inline constexpr unsigned kFirstTexel = 21;  ///< magnitude class of the first texel of plane 0
inline constexpr unsigned kSignClasses = 5;
inline constexpr unsigned kRowSize = 128;
inline constexpr unsigned kSets = 4;            ///< static table sets a chunk chooses from
inline constexpr unsigned kDistributions = 64;  ///< members of the shared family
inline constexpr unsigned kHitContexts = 64;    ///< 11 scores × 5 votes, padded

inline constexpr unsigned kPlaneRows = 2 * 3 * kModes;  ///< keyframe/update × plane class × mode
inline constexpr unsigned kPairRows = 2 * 2 * kModes;   ///< keyframe/update × plane × mode
inline constexpr unsigned kModeRow = kPlaneRows + kPairRows;
inline constexpr unsigned kRows = kModeRow + 1;

constexpr unsigned plane_row(bool update, unsigned plane, unsigned mode) {
  return ((update ? 3U : 0U) + (plane < 2 ? plane : 2U)) * kModes + mode;
}
constexpr unsigned pair_row(bool update, unsigned plane, unsigned mode) {
  return kPlaneRows + ((update ? 2U : 0U) + plane) * kModes + mode;
}
/// Context of the symbol that carries a block's mode.
constexpr unsigned mode_context(bool pairs, bool update, unsigned plane) {
  return kModeRow * kRowSize + (pairs ? 2 + plane : (update ? 1U : 0U));
}

/// What a block is predicted from.
enum class Reference : std::uint8_t {
  constant,    ///< planes: half of the range; pairs: 0
  cap,         ///< pairs: the chunk's cap value
  past,        ///< the block in the mirror
  neighbours,  ///< average of the neighbours' current blocks
  change,      ///< past plus the average change of the neighbours
};
inline constexpr std::uint8_t kX = 1, kY = 2, kZ = 4;

/// A reference block and a causal operator on the difference to it: weights of W, N, NW, NE in
/// eighths, and the weight of plane 0's residual in quarters.
struct Mode {
  Reference reference;
  std::uint8_t neighbours;  ///< kX | kY | kZ
  std::int8_t w, n, nw, ne;
  std::uint8_t cross;
};

inline constexpr Mode kPlaneUpdateModes[kModes] = {
    {Reference::past, 0, 4, 2, 0, 2, 3}, {Reference::past, 0, 2, 2, 0, 0, 0},
    {Reference::past, 0, 4, 2, 0, 2, 0}, {Reference::past, 0, 6, 6, -4, 0, 4},
    {Reference::past, 0, 0, 0, 0, 0, 0}, {Reference::past, 0, 4, 0, 0, 4, 4},
    {Reference::past, 0, 2, 2, 0, 0, 4}, {Reference::change, kX | kZ, 0, 0, 0, 0, 0},
};
inline constexpr Mode kPlaneKeyModes[kModes] = {
    {Reference::constant, 0, 8, 8, -8, 0, 4},
    {Reference::neighbours, kX | kZ, 6, 6, -4, 0, 4},
    {Reference::neighbours, kY, 6, 6, -4, 0, 4},
    {Reference::neighbours, kX, 6, 6, -4, 0, 4},
    {Reference::neighbours, kZ, 6, 6, -4, 0, 4},
    {Reference::neighbours, kX | kY | kZ, 6, 6, -4, 0, 4},
    {Reference::neighbours, kX | kY, 6, 6, -4, 0, 4},
    {Reference::neighbours, kY | kZ, 6, 6, -4, 0, 4},
};
/// First and second plane of a pair, update; `cross` is not used.
inline constexpr Mode kPairUpdateModes[2][kModes] = {
    {{Reference::past, 0, 2, 2, 0, 0, 0},
     {Reference::past, 0, 6, 6, -4, 0, 0},
     {Reference::past, 0, 0, 0, 0, 0, 0},
     {Reference::past, 0, 4, 2, 0, 2, 0},
     {Reference::change, kX, 2, 1, 0, 1, 0},
     {Reference::change, kY, 2, 1, 0, 1, 0},
     {Reference::change, kZ, 2, 1, 0, 1, 0},
     {Reference::cap, 0, 6, 6, -4, 0, 0}},
    {{Reference::past, 0, 2, 1, 0, 1, 0},
     {Reference::past, 0, 0, 0, 0, 0, 0},
     {Reference::past, 0, 4, 2, 0, 2, 0},
     {Reference::past, 0, 2, 2, 0, 0, 0},
     {Reference::constant, 0, 2, 2, 0, 0, 0},
     {Reference::change, kX | kY | kZ, 0, 0, 0, 0, 0},
     {Reference::change, kY, 0, 0, 0, 0, 0},
     {Reference::neighbours, kZ, 2, 2, 0, 0, 0}},
};
/// Keyframes of pairs choose per texel and plane among these by what they left around; nothing is
/// signalled.
inline constexpr Mode kPairKeyModes[2][kModes] = {
    {{Reference::cap, 0, 6, 6, -4, 0, 0},
     {Reference::neighbours, kX, 6, 6, -4, 0, 0},
     {Reference::neighbours, kY, 6, 6, -4, 0, 0},
     {Reference::neighbours, kZ, 6, 6, -4, 0, 0},
     {Reference::neighbours, kX, 2, 2, 0, 0, 0},
     {Reference::neighbours, kY, 2, 2, 0, 0, 0},
     {Reference::neighbours, kZ, 2, 2, 0, 0, 0},
     {Reference::cap, 0, 2, 1, 0, 1, 0}},
    {{Reference::constant, 0, 2, 1, 0, 1, 0},
     {Reference::constant, 0, 8, 8, -8, 0, 0},
     {Reference::constant, 0, 2, 2, 0, 0, 0},
     {Reference::neighbours, kX, 2, 2, 0, 0, 0},
     {Reference::neighbours, kY, 2, 2, 0, 0, 0},
     {Reference::neighbours, kZ, 2, 2, 0, 0, 0},
     {Reference::neighbours, kX, 2, 1, 0, 1, 0},
     {Reference::neighbours, kY, 2, 1, 0, 1, 0}},
};

/// Thresholds of the magnitude class: the class is the number of thresholds ≤ s. Those from 16, 64
/// and 256 on are multiples of 4, 16 and 256 so that four 16-entry look-ups find the class.
inline constexpr std::uint16_t kThresholds[] = {
    1, 3, 5, 8, 11, 16, 24, 36, 48, 64, 96, 144, 192, 256, 512, 768, 1024, 1536, 2048, 3072};

/// Magnitude class table for s in steps of 2^shift: what 16 entries starting at 0 know.
constexpr NibbleTable magnitude_table(unsigned shift) {
  NibbleTable table{};
  for (unsigned i = 0; i < 16; ++i) {
    std::uint8_t c = 0;
    for (auto t : kThresholds) c = static_cast<std::uint8_t>(c + ((i << shift) >= t));
    table.entry[i] = c;
  }
  return table;
}

/// Candidates of a pair's exact repetition, by index.
inline constexpr unsigned kCandidates = 7;  // past, X, Y, Z, W, N, cap

}  // namespace gicodec::native
