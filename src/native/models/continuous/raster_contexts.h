// The contexts of the model of continuous textures (docs/native/continuous.md).
#pragma once

#include <cstdint>

namespace gicodec::native {

/// First number of a context's hash.
enum RasterContext : std::uint32_t {
  // texel_repeats.cpp
  kRepeat = 16,
  kRepeatAround = 17,
  kRepeatPattern = 18,
  kRepeatMatch = 19,
  kRepeatBoth = 20,
  kRepeatDeep = 21,
  // texel_residuals.cpp
  kNeighbours = 32,
  kPrediction = 48,
  kEnergy = 64,
  kSpread = 80,
  kGradient = 96,
  kSignAround = 112,
  kSignBefore = 128,
  kSignNeighbours = 144,
  kDigit = 160,
};

}  // namespace gicodec::native
