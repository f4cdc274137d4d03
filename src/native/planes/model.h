// The normative constants of the native bitstream's models: symbols, modes, contexts
// (docs/native.md).
#pragma once

#include "simd/vector.h"

#include <bit>
#include <cstdint>

namespace gicodec::native {

inline constexpr std::uint8_t kVersion = 3;
using gicodec::kLanes;
inline constexpr unsigned kModes = 8;
inline constexpr unsigned kMaxPlanes = 32;

// Entropy coder: 32-bit states from kStateLow on, 16-bit words.
inline constexpr unsigned kProbabilityBits = 12;
inline constexpr std::uint32_t kProbabilityScale = 1U << kProbabilityBits;
using gicodec::kStateLow;

// Symbols of values, shifted down by the distribution's shift: 15 is 0, then come 1, 2, … 7,
// ranges, and an escape that holds any value.
inline constexpr unsigned kSymbols = 16;
inline constexpr unsigned kListed = kSymbols - 1;  ///< those that a distribution gives units
inline constexpr unsigned kEscape = 14;
inline constexpr unsigned kZero = 15;
inline constexpr std::uint8_t kBase[kSymbols] = {1,  2,  3,  4,  5,  6,   7, 8,
                                                 12, 16, 24, 32, 64, 128, 0, 0};
inline constexpr std::uint8_t kRawBits[kSymbols] = {0, 0, 0, 0, 0, 0, 0,  2,
                                                    2, 3, 3, 5, 6, 7, 16, 0};

constexpr unsigned symbol_of(unsigned shifted) {
  if (shifted == 0) return kZero;
  if (shifted < 8) return shifted - 1;
  if (shifted < 16) return 7 + (shifted >= 12);
  if (shifted < 32) return 9 + (shifted >= 24);
  if (shifted < 256) return 5 + static_cast<unsigned>(std::bit_width(shifted));
  return kEscape;
}
static_assert(symbol_of(31) == 10 && symbol_of(32) == 11 && symbol_of(255) == 13);
constexpr unsigned raw_bits_of(unsigned symbol, unsigned shift) {
  return kRawBits[symbol] + shift < 16 ? kRawBits[symbol] + shift : 16;
}

// Contexts: 64·class + 16·sign + magnitude, in roles with tables of their own; where signs of other
// planes are followed, 64·class + 8·sign + magnitude of up to 7.
inline constexpr unsigned kClassStep = 64, kSignStep = 16;
/// Class of update modes whose later high planes follow the signs of those before.
inline constexpr unsigned kFollowClass = 3;
inline constexpr unsigned kContexts = 256;      ///< of a role
inline constexpr unsigned kFirstTexel = 15;     ///< magnitude at the first texel of plane 0
inline constexpr unsigned kDistributions = 16;  ///< distributions of a role in a set
inline constexpr unsigned kSets = 8;            ///< static tables that a role chooses from
inline constexpr unsigned kMaxShift = 7,
                          kMaxUnit = 4;          ///< of a distribution; its unit as a logarithm
inline constexpr unsigned kRepeatContexts = 64;  ///< 11 scores × 5 votes, padded

inline constexpr unsigned kModeRole = 10, kRoles = 11;
constexpr unsigned role_of(bool pairs, bool update, unsigned plane) {
  return pairs ? 6 + (update ? 2U : 0U) + plane : (update ? 3U : 0U) + (plane < 2 ? plane : 2U);
}
/// Places of a chunk's roles: planes 0, 1 and others, repeats of pairs, modes.
inline constexpr unsigned kPlaces = 4, kRepeatPlace = 2, kModePlace = 3;
/// `low`: planes that are low halves, by bit; where there are any, the second place is theirs.
constexpr unsigned place_of(unsigned plane, std::uint32_t low) {
  if (plane == 0) return 0;
  if (low != 0) return (low >> plane & 1) != 0 ? 1 : 2;
  return plane < 2 ? plane : 2;
}
/// Blocks whose texels may be repeated: previous, X, Y, Z.
inline constexpr unsigned kBlockCandidates = 4;
/// Those with residuals.
constexpr unsigned residual_places(bool pairs) { return pairs ? 2 : 3; }
/// Context of the symbol that carries a block's mode.
constexpr unsigned mode_context(bool pairs, bool update, unsigned plane) {
  return pairs ? 2 + plane : (update ? 1U : 0U);
}

/// What a block is predicted from.
enum class Reference : std::uint8_t {
  constant,    ///< planes: half of the range; pairs: 0
  frequent,    ///< pairs: the chunk's frequent value
  previous,    ///< the block in the mirror
  neighbours,  ///< average of the neighbours' current blocks
  change,      ///< previous plus the average change of the neighbours
};
inline constexpr std::uint8_t kX = 1, kY = 2, kZ = 4;

/// A reference block and a causal operator on the difference to it: weights of W, N, NW, NE in
/// eighths, the weight of plane 0's residual in quarters; and the class of its contexts.
struct Mode {
  Reference reference;
  std::uint8_t neighbours;  ///< kX | kY | kZ
  std::int8_t w, n, nw, ne;
  std::uint8_t cross;
  std::uint8_t context_class = 0;
};

inline constexpr Mode kPlaneUpdateModes[kModes] = {
    {Reference::previous, 0, 4, 2, 0, 2, 3, 0}, {Reference::previous, 0, 2, 2, 0, 0, 0, 1},
    {Reference::previous, 0, 4, 2, 0, 2, 0, 1}, {Reference::previous, 0, 6, 6, -4, 0, 4, 2},
    {Reference::previous, 0, 0, 0, 0, 0, 0, 3}, {Reference::previous, 0, 4, 0, 0, 4, 4, 0},
    {Reference::previous, 0, 2, 2, 0, 0, 4, 0}, {Reference::change, kX | kZ, 0, 0, 0, 0, 0, 3},
};
inline constexpr Mode kPlaneKeyModes[kModes] = {
    {Reference::constant, 0, 8, 8, -8, 0, 4, 0},
    {Reference::neighbours, kX | kZ, 6, 6, -4, 0, 4, 2},
    {Reference::neighbours, kY, 6, 6, -4, 0, 4, 1},
    {Reference::neighbours, kX, 6, 6, -4, 0, 4, 1},
    {Reference::neighbours, kZ, 6, 6, -4, 0, 4, 1},
    {Reference::neighbours, kX | kY | kZ, 6, 6, -4, 0, 4, 3},
    {Reference::neighbours, kX | kY, 6, 6, -4, 0, 4, 2},
    {Reference::neighbours, kY | kZ, 6, 6, -4, 0, 4, 2},
};
/// First and second plane of a pair, update; `cross` is not used.
inline constexpr Mode kPairUpdateModes[2][kModes] = {
    {{Reference::previous, 0, 2, 2, 0, 0, 0, 0},
     {Reference::previous, 0, 6, 6, -4, 0, 0, 1},
     {Reference::previous, 0, 0, 0, 0, 0, 0, 2},
     {Reference::previous, 0, 4, 2, 0, 2, 0, 0},
     {Reference::change, kX, 2, 1, 0, 1, 0, 3},
     {Reference::change, kY, 2, 1, 0, 1, 0, 3},
     {Reference::change, kZ, 2, 1, 0, 1, 0, 3},
     {Reference::frequent, 0, 6, 6, -4, 0, 0, 1}},
    {{Reference::previous, 0, 2, 1, 0, 1, 0, 0},
     {Reference::previous, 0, 0, 0, 0, 0, 0, 1},
     {Reference::previous, 0, 4, 2, 0, 2, 0, 0},
     {Reference::previous, 0, 2, 2, 0, 0, 0, 0},
     {Reference::constant, 0, 2, 2, 0, 0, 0, 2},
     {Reference::change, kX | kY | kZ, 0, 0, 0, 0, 0, 3},
     {Reference::change, kY, 0, 0, 0, 0, 0, 3},
     {Reference::neighbours, kZ, 2, 2, 0, 0, 0, 2}},
};
/// Keyframes of pairs choose per texel and plane among these by what they left around; nothing is
/// signalled.
inline constexpr Mode kPairKeyModes[2][kModes] = {
    {{Reference::frequent, 0, 6, 6, -4, 0, 0},
     {Reference::neighbours, kX, 6, 6, -4, 0, 0},
     {Reference::neighbours, kY, 6, 6, -4, 0, 0},
     {Reference::neighbours, kZ, 6, 6, -4, 0, 0},
     {Reference::neighbours, kX, 2, 2, 0, 0, 0},
     {Reference::neighbours, kY, 2, 2, 0, 0, 0},
     {Reference::neighbours, kZ, 2, 2, 0, 0, 0},
     {Reference::frequent, 0, 2, 1, 0, 1, 0}},
    {{Reference::constant, 0, 2, 1, 0, 1, 0},
     {Reference::constant, 0, 8, 8, -8, 0, 0},
     {Reference::constant, 0, 2, 2, 0, 0, 0},
     {Reference::neighbours, kX, 2, 2, 0, 0, 0},
     {Reference::neighbours, kY, 2, 2, 0, 0, 0},
     {Reference::neighbours, kZ, 2, 2, 0, 0, 0},
     {Reference::neighbours, kX, 2, 1, 0, 1, 0},
     {Reference::neighbours, kY, 2, 1, 0, 1, 0}},
};

/// Thresholds of the magnitude: the number of thresholds ≤ s. Those from 16, 64 and 256 on are
/// multiples of 4, 16 and 256 so that four 16-entry look-ups find it.
using Thresholds = std::uint16_t[15];
inline constexpr Thresholds kNarrowThresholds = {1,  3,  5,  8,   11,  16,  24, 36,
                                                 48, 64, 96, 144, 208, 256, 512};
inline constexpr Thresholds kWideThresholds = {1,   4,   8,   16,  32,   48,   64,  96,
                                               144, 208, 256, 512, 1024, 2048, 3072};

/// Magnitudes of s in steps of 2^shift: the 16 entries from 0 on.
constexpr NibbleTable magnitude_table(const Thresholds& thresholds, unsigned shift) {
  NibbleTable table{};
  for (unsigned i = 0; i < 16; ++i) {
    std::uint8_t c = 0;
    for (auto t : thresholds) c = static_cast<std::uint8_t>(c + ((i << shift) >= t));
    table.entry[i] = c;
  }
  return table;
}

/// Candidates of a pair's exact repetition, by index.
inline constexpr unsigned kCandidates = 7;  // previous, X, Y, Z, W, N, frequent

}  // namespace gicodec::native
