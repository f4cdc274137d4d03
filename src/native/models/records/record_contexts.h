// The contexts of the record model (docs/native/records.md).
#pragma once

#include <cstdint>

namespace gicodec::native {

/// First number of a context's hash; where contexts differ by component, the component is added.
enum RecordContext : std::uint32_t {
  // record_model.cpp
  kChanged = 1,
  kChanged2 = 2,
  kChanged3 = 3,
  kComponents = 7,
  kComponents2 = 8,
  kComponents3 = 9,
  kSame = 32,
  kSame2 = 48,
  kSame3 = 64,
  kMatch = 80,
  kMatch2 = 96,
  kMatch3 = 112,
  kNew = 128,
  kNewBefore = 144,
  kNewOthers = 160,
  kNewBoth = 176,
  kNewEqual = 192,
  // record_rows.cpp
  kRowChanged = 4,
  kRowChanged2 = 5,
  kRowChanged3 = 6,
  kCopy2 = 10,
  kCopy3 = 11,
  kHigh = 208,
  kHighSimilar = 224,
  kHighPrevious = 240,
  kHighLast = 256,
  kHighBoth = 272,
  kDown = 400,
  kDownPrevious = 416,
  kDownSimilar = 432,
  kLow = 448,
  kLowPlace = 464,
  kLowHalf = 480,
  kCopy = 496,
  // record_values.cpp
  kAround = 288,
  kOthers = 304,
  kBoth = 320,
  kSize = 336,
  kNoise = 352,
  kSign = 368,
  kSignOthers = 384,
};

}  // namespace gicodec::native
