// Up to 32 rows of a raster in lanes, each two columns behind the one above (docs/native/rows.md).
#pragma once

#include "simd/vector.h"

#include <gicodec/record.h>

#include <cstddef>
#include <cstdint>

namespace gicodec::native {

inline constexpr unsigned kRowDelay = 2;  ///< columns
/// Guesses of a channel, and parts of the lead's residual that are added.
inline constexpr unsigned kRowGuesses = 5, kRowParts = 4;
/// What is kept of a channel at a texel: its value, its residual, errors of guesses and of parts.
inline constexpr unsigned kRowTrail = 2 + kRowGuesses + kRowParts;
/// A step's trail of one kind: a word from the strip above, and the lanes'; and how many steps
/// back.
inline constexpr unsigned kTrailStride = 40, kTrailSteps = 4;
/// Contexts of a class.
inline constexpr unsigned kRowClass = 64;

/// Steps of a strip.
constexpr std::size_t row_steps(std::size_t columns) {
  return columns + std::size_t{kRowDelay} * (kLanes - 1);
}

struct RowChannel {
  std::uint16_t* values;  ///< [step][lane]: encoding reads, decoding writes
  // [step][lane], with a step before the first: of the slice before and in the mirror, there and in
  // the row above.
  const std::uint16_t *slice, *slice_above, *past, *past_above;
  /// [step][lane], of the slice before and then of this one; null unless there are slices.
  std::uint16_t* z_residuals;
  std::uint16_t* above;   ///< [trail][column] of the last row of the strip before, then of this one
  unsigned bits;          ///< of residuals
  std::uint16_t largest;  ///< value
  bool in_units;          ///< a mantissa, in units of the texel's exponent
  bool low;               ///< low half of a channel, the high half of which is channel `high`
  std::uint8_t high;
  /// Of mantissas with a palette: places by value, and values by place; else null.
  const std::uint16_t *nearest, *palette;
  std::uint16_t last_place;
};

struct RowStrip {
  unsigned columns, rows;
  bool first;   ///< of its slice: there is no row above
  bool deep;    ///< there is a slice before
  bool update;  ///< there is a past
  unsigned channels, lead;
  RowChannel channel[kMaxComponents];
  std::uint16_t* above;      ///< [column]: which texels of the row above repeat
  std::uint16_t* z_repeats;  ///< as z_residuals: which texels repeat
  std::uint16_t* trail;      ///< trail_size() values
};
/// Words from a column to the next trail's in `above`.
constexpr std::size_t above_stride(std::size_t columns) { return columns + 8; }
constexpr std::size_t trail_size(unsigned channels) {
  return (std::size_t{channels} * kRowTrail + 1) * kTrailSteps * kTrailStride;
}
constexpr unsigned row_guesses(bool deep, bool update) {
  return deep ? kRowGuesses : update ? kRowGuesses - 1 : 2;
}

}  // namespace gicodec::native
