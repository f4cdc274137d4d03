// The loops behind YUV444P16 and YUV444P8 (yuv444p16.h, yuv444p8.h).
#pragma once

#include "simd/dispatch.h"

#include <cstddef>
#include <cstdint>

namespace gicodec {

/// First bits of three 10-bit codes in a 32-bit texel, and of a code in its 16-bit sample (`up`).
struct CodeShifts {
  unsigned y, u, v, up;
};

/// Any count; buffers do not overlap.
struct Yuv444Kernels {
  /// 32-bit texels → three planes of samples.
  void (*split_codes)(const std::byte* texels, std::size_t count, CodeShifts shifts,
                      std::uint16_t* y, std::uint16_t* u, std::uint16_t* v);
  /// The inverse; returns the OR of all samples.
  std::uint16_t (*join_codes)(const std::uint16_t* y, const std::uint16_t* u,
                              const std::uint16_t* v, std::size_t count, CodeShifts shifts,
                              std::byte* texels);
  /// y[i], u[i], v[i] ↔ bytes[3i], bytes[3i+1], bytes[3i+2].
  void (*split_bytes)(const std::byte* bytes, std::size_t count, std::uint8_t* y, std::uint8_t* u,
                      std::uint8_t* v);
  void (*join_bytes)(const std::uint8_t* y, const std::uint8_t* u, const std::uint8_t* v,
                     std::size_t count, std::byte* bytes);
};

}  // namespace gicodec
