// What a token says: groups of planes, and the numbers of their tokens (docs/native/tokens.md).
#pragma once

#include "native/planes/planes.h"
#include "native/tokens/prefix_code.h"

#include <array>
#include <cstdint>

namespace gicodec::native {

inline constexpr unsigned kMaxGroupPlanes = 3, kMaxGroups = kMaxPlanes;
inline constexpr unsigned kCopies = 3;  ///< of neighbours X, Z, Y
/// Most bits of the planes of a group of three.
inline constexpr unsigned kNarrowBits = 10;

/// What the differences of a group to its reference are predicted from.
/// `gradient`: W + N - NW.
enum class TokenPrediction : std::uint8_t { none, north, west, gradient };
inline constexpr unsigned kTokenPredictions = 4;
/// Of these, groups that copy have so many.
inline constexpr unsigned kCopyingPredictions = 2;

/// Planes whose residuals at a texel are one token, and raw bits.
struct TokenGroup {
  std::array<std::uint8_t, kMaxGroupPlanes> plane{}, bits{};
  std::uint8_t planes = 0;
  std::uint8_t small = 0;   ///< tokens of residuals from -1 to 1: 3 to the power of planes
  std::uint8_t copies = 0;  ///< tokens of a neighbour's texel, behind the small ones
  std::uint8_t widest = 0;  ///< bits of the largest residual, doubled where it is no first plane's
  bool follows = false;     ///< later planes' differences are to that of the first one
  bool sparse = false;      ///< units whose tokens are all 0 are marked, and have no codes
  TokenPrediction prediction = TokenPrediction::none;

  /// Whether follows may be set.
  [[nodiscard]] bool can_follow() const noexcept {
    return planes > 1 && copies == 0 && bits[1] == bits[0] && (planes == 2 || bits[2] == bits[0]);
  }
  /// Token base() + c has c raw bits for the first plane and c - 1 for each other; 16 each for 16.
  [[nodiscard]] unsigned base() const noexcept { return small + copies - 2U; }
  [[nodiscard]] unsigned tokens() const noexcept { return base() + widest + 1U; }
  [[nodiscard]] unsigned raw_bits(unsigned c) const noexcept {
    return c == 16 ? 16U * planes : c * planes - (planes - 1U);
  }
};

struct TokenGroups {
  std::array<TokenGroup, kMaxGroups> group;
  unsigned count = 0;
};

/// Cuts the planes that are coded, by bit, into groups.
[[nodiscard]] TokenGroups token_groups(const PlaneLayout& layout, std::uint32_t coded) noexcept;

}  // namespace gicodec::native
