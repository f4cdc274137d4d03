// The contexts of the set model (docs/native/unordered.md).
#pragma once

#include <cstdint>

namespace gicodec::native {

/// First number of a context's hash, to which an axis or component is added.
enum SetContext : std::uint32_t {
  // set_model.cpp
  kOrdered = 1,
  kZeros = 2,
  kShared = 10,  // + axis, and the next ones likewise
  kShared2 = 13,
  kShared3 = 16,
  kRecent = 20,
  kRecentLeaf = 23,
  kRecent2 = 26,
  kRecent2Leaf = 29,
  kRecent3 = 32,
  kRecent3Leaf = 35,
  kLeft = 40,
  kLeft2 = 41,
  kLeft3 = 42,
  kBit = 50,
  kBit2 = 53,
  kBit3 = 56,
  kEqual = 100,  // + component
  kEqual2 = 116,
  kEqual3 = 132,
  kValue = 150,
  kAfterOthers = 166,
  kNearBefore = 182,
  kOnPlane = 198,
  kInCell = 214,
  // set_update.cpp
  kSetEqual = 3,
  kPairs = 4,
  kKept = 5,
  kRecordChanged = 60,
  kUnchanged = 230,  // + component, and the next ones likewise
  kUnchanged2 = 246,
  kUnchanged3 = 262,
  kDifference = 278,
  kAfterDifference = 294,
  kFromPrevious = 310,
  kFromBoth = 326,
  kAfterChanges = 342,
};

}  // namespace gicodec::native
