// Texels ↔ planes of up to 16 bits, block by block.
#pragma once

#include <gicodec/texture.h>

#include "native/planes/model.h"

#include <cstddef>
#include <cstdint>

namespace gicodec::native {

/// How a format is cut into planes. Components above 16 bits give two planes, high half first; of
/// three or more components the second comes first, since it predicts the others best.
struct PlaneLayout {
  struct Plane {
    std::uint8_t byte;  ///< offset of the 16- or 32-bit word the plane lies in
    std::uint8_t shift;
    std::uint8_t stored;  ///< bits in the record
    std::uint8_t bits;    ///< of what is coded: the value, or how many steps it is
    std::uint16_t step;
  };
  Plane plane[kMaxPlanes];
  unsigned planes = 0;
  unsigned texel_bytes = 0;
  std::uint32_t low = 0;  ///< planes that are low halves of components, by bit
  bool shared = false;    ///< the last plane is the exponent of all others
  bool pairs = false;     ///< the pair model: plane 1 is m2 − 2·m1; every record exists
  bool partial = false;   ///< not every record exists
  bool stepped = false;   ///< some step is above 1

  /// Modes that a block of a keyframe or update signals.
  [[nodiscard]] unsigned mode_kinds(bool update) const { return pairs ? (update ? 2 : 0) : 1; }
};
[[nodiscard]] PlaneLayout plane_layout(const TextureDesc& desc) noexcept;
/// Whether a plane can have such a step, and giving it one.
[[nodiscard]] bool valid_step(const PlaneLayout& layout, unsigned plane, unsigned step) noexcept;
void set_step(PlaneLayout& layout, unsigned plane, unsigned step) noexcept;

/// Bytes of a block's planes.
[[nodiscard]] inline std::uint64_t block_words(const TextureDesc& desc) noexcept {
  return std::uint64_t{2} * plane_layout(desc).planes * record_count(desc.block);
}

/// Blocks that the lanes of a thread take the room of, at most: the pair model follows eight
/// predictions, shared exponents have scales.
[[nodiscard]] inline std::uint64_t lane_blocks(const TextureDesc& desc) noexcept {
  const PlaneLayout layout = plane_layout(desc);
  return layout.pairs ? 1280 : layout.shared ? 432 : 384;
}

/// Values of one block: planes one after the other, then room for whole vectors.
[[nodiscard]] constexpr std::size_t block_stride(unsigned planes, std::size_t texels) {
  return ((planes * texels + 7) / 8 + 4) * 8;
}

}  // namespace gicodec::native
