// What the instruction sets implement: coding a group of up to 32 blocks in lockstep. The same
// source (*.inl) is compiled once per set.
#pragma once

#include "native/planes/model.h"
#include "native/planes/planes.h"
#include "native/planes/tables.h"
#include "native/rows/row_strip.h"
#include "simd/dispatch.h"

#include <cstddef>
#include <cstdint>

namespace gicodec::native {

/// Slack that buffers need beyond their data: vectors are read and written whole.
inline constexpr std::size_t kSlack = 192;
/// More bytes than one step (token and raw bits of every lane) can take.
inline constexpr std::size_t kMaxStepBytes = std::size_t{2} * 2 * kLanes;
/// More bytes than one texel can take; the input is checked once per texel.
inline constexpr std::size_t kMaxTexelBytes = (1 + kMaxPlanes) * kMaxStepBytes;

/// Reader of a chunk's words; `next` may run past `end` by kMaxTexelBytes.
struct Input {
  alignas(64) std::uint16_t high[kLanes];  ///< words of the states
  alignas(64) std::uint16_t low[kLanes];
  const std::uint8_t* next;
  const std::uint8_t* end;
};
/// Writer of a chunk's words, from the end of a buffer to its begin.
struct Output {
  alignas(64) std::uint32_t state[kLanes];
  std::uint8_t* next;
};

/// The symbols that all lanes code at once, in decoding order.
struct Step {
  alignas(64) std::uint16_t context[kLanes];  ///< of the role in that place, or of a repeat
  alignas(64) std::uint16_t value[kLanes];
  std::uint32_t active;  ///< lanes that take part, by bit
  std::uint16_t repeat;  ///< 1: the value is a repeat symbol, 0: it is a token value
  std::uint16_t place;
  std::uint16_t plane;  ///< of a residual
};

/// Lanes in which a record exists, by bit, and those that have one before it.
struct Present {
  std::uint32_t here, before;
};

/// Blocks in lanes: arrays [plane][texel][lane].
struct Group {
  std::uint32_t active;    ///< lanes in use, of blocks that have records
  const Present* present;  ///< [texel]; null: all records of these lanes exist
  unsigned width, rows;
  unsigned planes;
  bool update;
  std::uint8_t bits[kMaxPlanes];
  std::uint32_t coded;  ///< planes that are coded, by bit; the others are constant
  std::uint32_t low;    ///< planes that are low halves of components, by bit
  bool shared;          ///< planes: the last one is the exponent of all others
  bool repeats;         ///< planes: each texel begins with the candidate that it repeats
  alignas(64) std::uint16_t mode[2][kLanes];  ///< planes use the first row only
  std::uint16_t frequent[2];
  const std::uint16_t* reference;  ///< [plane][texel][lane]; keyframes of pairs: unused
  const std::uint16_t*
      candidate[kBlockCandidates];  ///< previous, X, Y, Z: of pairs, and for repeats
  std::uint16_t* current;           ///< decoding writes, encoding reads
  std::uint16_t* scratch;           ///< scratch_size() values
};
/// Values of Group::scratch: differences and residuals of every plane, what was repeated and which
/// candidate that was, shared exponents and five scales; or of both planes and every keyframe mode
/// of a pair, and its two match arrays.
constexpr std::size_t scratch_size(std::size_t texels, unsigned planes, bool pairs, bool shared) {
  const unsigned of_planes = 2 * planes + (shared ? 8 : 2);
  return std::size_t{pairs ? 2 + 4 + 4 * kModes : of_planes} * texels * kLanes;
}

/// Some rows of a group's blocks, and modes that share a reference.
struct CostJob {
  const std::uint16_t* current;  ///< [plane][texel][lane], as the group's
  const std::uint16_t* reference;
  const Present* present;  ///< as the group's
  std::size_t texels;      ///< of the whole block
  unsigned width, planes;
  unsigned first_row, rows;  ///< the sampled ones; the row above is read too
  bool scaled;               ///< the last plane is the exponent of all others
  bool wide;                 ///< 16-bit arithmetic of pairs and deep planes
  const Mode* modes;
  unsigned count;
  std::uint16_t* scratch;  ///< cost_scratch_size() values
};
/// Texels that a job samples, at most, unless one row has more.
inline constexpr unsigned kMaxSampled = 64;
constexpr std::size_t cost_scratch_size(unsigned width, unsigned planes) {
  const std::size_t texels = width < kMaxSampled ? kMaxSampled : width;
  return (planes + 1) * (texels + width + 1) * kLanes;
}

struct Kernels {
  /// A block of texels to planes and back.
  void (*unpack)(const PlaneLayout&, const std::uint8_t* in, std::size_t texels,
                 std::uint16_t* planes);
  void (*pack)(const PlaneLayout&, const std::uint16_t* planes, std::size_t texels,
               std::uint8_t* out);
  /// Values of a block's planes ↔ how many steps they are (docs/native.md, "Planes").
  void (*to_steps)(const PlaneLayout&, std::size_t texels, std::uint16_t* planes);
  void (*from_steps)(const PlaneLayout&, std::size_t texels, std::uint16_t* planes);
  /// Whether every value of plane `plane` is a whole number of steps.
  bool (*has_steps)(const PlaneLayout&, unsigned plane, const std::uint16_t* values,
                    std::size_t texels);
  /// Transposes `count` values (a multiple of 8) of 32 blocks into lanes and back.
  void (*to_lanes)(const std::uint16_t* const* blocks, std::size_t count, std::uint16_t* lanes);
  void (*from_lanes)(const std::uint16_t* lanes, std::size_t count, std::uint16_t* const* blocks);
  /// Residuals of a group as steps, appended from `steps` on; returns their end.
  Step* (*model_planes)(const Group&, Step* steps);
  Step* (*model_pairs)(const Group&, Step* steps);
  /// The inverse. False if the input is too short.
  bool (*decode_planes)(const Group&, const Tables&, Input&);
  bool (*decode_pairs)(const Group&, const Tables&, Input&);
  /// The same of a strip of rows.
  Step* (*model_rows)(const RowStrip&, Step* steps);
  bool (*decode_rows)(const RowStrip&, const Tables&, Input&);
  /// One step of the same context for all lanes.
  bool (*decode_values)(const RoleTables&, std::uint32_t active, std::uint16_t context, Input&,
                        std::uint16_t* values);
  /// Codes steps in reverse order.
  void (*encode_steps)(const Step* begin, const Step* end, const Tables&, Output&);
  /// Adds to cost[lane] what the token steps of a place cost, in 1/256 bits.
  void (*price_steps)(const Step* begin, const Step* end, unsigned place, const RoleTables&,
                      std::uint32_t* cost);
  /// About what coding those rows by each mode costs in every lane, in 1/16 bits. For encoders
  /// only.
  void (*cost)(const CostJob&, std::uint16_t (*costs)[kLanes]);
};

/// Those of an instruction set. Precondition: this machine supports it.
[[nodiscard]] inline const Kernels& kernels(Isa isa) noexcept {
  return gicodec::kernels<Kernels>(isa);
}

}  // namespace gicodec::native
