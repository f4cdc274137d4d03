// The loops behind byte planes (byte_planes.h).
#pragma once

#include <gicodec/record.h>

#include "simd/dispatch.h"

#include <cstddef>

namespace gicodec {

/// A Record for kernels: without functions, which would be compiled for the instruction set.
struct RecordLayout {
  const Component* component;
  unsigned count, bytes;
};

/// Records per step: a step's records and values stay in the first-level cache.
inline constexpr std::size_t kPlaneStep = 512;

/// Up to kPlaneStep records ↔ byte planes that are `stride` bytes apart. `reference` may be null.
/// Buffers do not overlap.
struct BytePlaneKernels {
  void (*to_planes)(const RecordLayout& record, const std::byte* records,
                    const std::byte* reference, std::byte* planes, std::size_t count,
                    std::size_t stride);
  void (*from_planes)(const RecordLayout& record, const std::byte* planes,
                      const std::byte* reference, std::byte* records, std::size_t count,
                      std::size_t stride);
};

}  // namespace gicodec
