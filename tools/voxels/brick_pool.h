// Bricks of an octree in slots that they keep.
#pragma once

#include "octree.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gicodec::voxels {

/// How voxels of a brick of side 4 or 8 are numbered.
struct BrickShape {
  unsigned side = 4;

  [[nodiscard]] unsigned key_bits() const { return side == 4 ? 6 : 9; }
  [[nodiscard]] unsigned voxels() const { return side * side * side; }
  [[nodiscard]] std::size_t mask_bytes() const { return voxels() / 8; }
  [[nodiscard]] std::size_t place_bytes() const { return kBrickPlaceBytes + mask_bytes(); }
  /// The bit of a voxel in its brick's mask.
  [[nodiscard]] unsigned bit_of(const Cell& cell) const {
    return cell[0] % side + side * (cell[1] % side + side * (cell[2] % side));
  }
};

class BrickPool {
 public:
  /// Precondition: 1 to kMaxBlocks slots.
  BrickPool(std::uint32_t slots, BrickShape shape, VoxelForm form);

  /// Bricks of the octree's voxels with their light. A brick that was there keeps its slot; others
  /// get the first free ones, each next to those in it: parts of a texture that are coded one by
  /// one (docs/native.md, section 1) are runs of slots, and know no other's bricks. Where there are
  /// not enough slots, the finest bricks are left out: returned is how many.
  std::uint64_t put(const Octree& octree);

  [[nodiscard]] const BrickShape& shape() const { return shape_; }
  [[nodiscard]] std::uint32_t slots() const { return slots_; }
  /// Textures of the volume.
  [[nodiscard]] std::span<const std::byte> bricks() const { return bricks_; }
  [[nodiscard]] std::span<const std::byte> light() const { return light_; }

 private:
  struct Brick {
    unsigned level = 0;
    VoxelKey key = 0;
    std::uint32_t slot = 0;
    std::size_t begin = 0, end = 0;  ///< voxels of its level

    [[nodiscard]] bool same(const Brick& other) const {
      return level == other.level && key == other.key;
    }
    [[nodiscard]] bool before(const Brick& other) const {
      return level != other.level ? level > other.level : key < other.key;
    }
    /// Depth first: before those in it and all that are behind it.
    [[nodiscard]] bool above(const Brick& other) const {
      const VoxelKey a = key << 3 * level, b = other.key << 3 * other.level;
      return a != b ? a < b : level > other.level;
    }
  };
  void write(const Brick& brick, const OctreeLevel& level);
  void clear(std::uint32_t slot);

  std::uint32_t slots_;
  BrickShape shape_;
  VoxelCode code_;
  std::vector<Brick> held_;  ///< coarse first, then by key
  std::vector<std::uint8_t> used_;
  std::vector<std::byte> bricks_, light_;
};

/// By level, the finest first.
[[nodiscard]] std::vector<std::uint64_t> brick_counts(const Octree& octree, BrickShape shape);

}  // namespace gicodec::voxels
