// The loops behind strip, reconstruct and the transforms, compiled once per instruction set. All
// implementations give the same bits. Pointers do not overlap; counts may be anything.
#pragma once

#include <gicodec/isa.h>
#include <gicodec/record.h>

#include <cstddef>
#include <cstdint>

namespace gicodec {

/// Bit positions of three 10-bit codes in a 32-bit texel and of each in its 16-bit sample.
struct CodeShifts {
  unsigned y, u, v, up;
};

/// Up to 64 square blocks at equal distances in a texture; a guard band is 0 or 1 record wide.
template <typename Byte>
struct BlockRun {
  Byte* first;  ///< first record of the first block, guard band included
  std::size_t row_pitch, step;
  unsigned count, core, guard_band, record_bytes;
};

/// A Record as kernels read it: without functions, which they would compile for their machine.
struct RecordLayout {
  const Component* component;
  unsigned count, bytes;
};

struct Kernels {
  /// Copies the records of a run, block after block. Bit i of the result: the guard band of
  /// block i does not follow the octahedral rule (texture/blocks.h).
  std::uint64_t (*strip_run)(const BlockRun<const std::byte>& run, std::byte* cores);
  /// Writes records and the guard bands that the rule gives.
  void (*reconstruct_run)(const std::byte* cores, const BlockRun<std::byte>& run);
  /// 32-bit texels → three planes of samples (transform/yuv444p16.h).
  void (*split_codes)(const std::byte* texels, std::size_t count, CodeShifts shifts,
                      std::uint16_t* y, std::uint16_t* u, std::uint16_t* v);
  /// The reverse; returns the bits that occur in any sample.
  std::uint16_t (*join_codes)(const std::uint16_t* y, const std::uint16_t* u,
                              const std::uint16_t* v, std::size_t count, CodeShifts shifts,
                              std::byte* texels);
  /// y[i], u[i], v[i] ↔ bytes[3i], bytes[3i+1], bytes[3i+2] (transform/yuv444p8.h).
  void (*split_bytes)(const std::byte* bytes, std::size_t count, std::uint8_t* y, std::uint8_t* u,
                      std::uint8_t* v);
  void (*join_bytes)(const std::uint8_t* y, const std::uint8_t* u, const std::uint8_t* v,
                     std::size_t count, std::byte* bytes);
  /// Up to 512 records ↔ byte planes that are `stride` bytes apart (transform/byte_planes.h).
  /// `reference` may be null.
  void (*to_planes)(const RecordLayout& record, const std::byte* records,
                    const std::byte* reference, std::byte* planes, std::size_t count,
                    std::size_t stride);
  void (*from_planes)(const RecordLayout& record, const std::byte* planes,
                      const std::byte* reference, std::byte* records, std::size_t count,
                      std::size_t stride);
};

/// Those of an instruction set. Precondition: this machine supports it.
[[nodiscard]] const Kernels& kernels(Isa isa) noexcept;

}  // namespace gicodec
