// The contexts of the light model (docs/native/light.md, docs/native/hemispheres.md).
#pragma once

#include <cstdint>

namespace gicodec::native {

/// First number of a context's hash. Added to it: 1 for the second of two similar numbers, 2 for
/// the second of two opposite hemispheres.
enum LightContext : std::uint32_t {
  // light_model.cpp
  kLit = 1,
  kEqual = 4,
  kLitHemisphere = 7,
  kAlpha = 20,  // five
  kAlphaSign = 240,
  // light_values.cpp
  kAcross = 10,  // of a direction's coordinates across the axis: five
  kAlong = 30,   // five, and three of the sign
  kExponent = 40,
  kGreen = 60,
  kOther = 80,
  kAcrossSign = 200,
  kAlongSign = 212,
  kExponentSign = 216,
  kGreenSign = 222,
  kOtherSign = 228,
};

}  // namespace gicodec::native
