// Where a grid of blocks stands in the world, and the regions it is cut into (Stengel et al. §3.4).
#pragma once

#include <gicodec/api.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace GICODEC_API gicodec {

using Position = std::array<float, 3>;  ///< world units

/// How far a camera-locked volume has moved, in cells along each axis, each within ±kMaxScroll.
using Scroll = std::array<std::int32_t, 3>;
inline constexpr std::int32_t kMaxScroll = 1 << 22;

/// The scene that volumes light. A renderer compares it with its own.
struct SceneId {
  std::string name = {};       ///< for people; at most 255 bytes of UTF-8; empty: unknown
  std::uint64_t geometry = 0;  ///< a hash that the application computes; 0: unknown
  friend bool operator==(const SceneId&, const SceneId&) = default;
};

/// Where the blocks of a grid stand. Cell c stands at origin + c · spacing; along an axis of n
/// blocks, c runs from scroll to scroll + n − 1. The texture holds cell c in block c mod n, so that
/// a scrolling volume replaces only the planes that enter. Without scrolling, c is the block.
struct VolumeGeometry {
  Grid grid;  ///< of the volume's first texture group; a pool: {slots, 1, 1}
  Position origin{0, 0, 0};
  Position spacing{1, 1, 1};  ///< positive
  Scroll scroll{0, 0, 0};

  friend bool operator==(const VolumeGeometry&, const VolumeGeometry&) = default;
};

/// invalid_geometry unless the grid has 1..kMaxBlocks blocks, all numbers are finite and in range,
/// and each spacing is positive.
Status validate(const VolumeGeometry& geometry) noexcept;

/// Where a block stands, in world units. Precondition: block is in the grid.
[[nodiscard]] Position block_position(const VolumeGeometry& geometry, std::uint32_t block) noexcept;

/// The blocks in the order of their cells: x fastest, ascending from the lowest cell of each axis.
/// Without scrolling 0, 1, 2, … Throws std::bad_alloc.
[[nodiscard]] std::vector<std::uint32_t> blocks_by_cell(const VolumeGeometry& geometry);

/// The scroll that moves the middle of the volume to within half a cell of `viewer`, clamped to
/// ±kMaxScroll. Precondition: `viewer` is finite.
[[nodiscard]] Scroll scroll_to(const VolumeGeometry& geometry, const Position& viewer) noexcept;

/// Blocks that stand elsewhere after scrolling (the planes that enter), ascending. Precondition:
/// the grid is that of a valid VolumeGeometry. Throws std::bad_alloc.
[[nodiscard]] std::vector<std::uint32_t> entering_blocks(Grid grid, const Scroll& from,
                                                         const Scroll& to);

/// Selects blocks of a grid: one byte per block, not 0 for members.
using BlockMask = std::vector<std::uint8_t>;

/// A grid or pool cut into regions: boxes of `size` blocks along each axis, smaller ones at the far
/// ends. Regions are numbered along x, then y, then z; so are the blocks within a region.
class RegionGrid {
 public:
  /// Sides of 0 count as 1. Precondition: the grid has no more blocks than kMaxBlocks.
  constexpr RegionGrid(Grid grid, Grid size) noexcept
      : grid_{one_at_least(grid)},
        size_{one_at_least(size)},
        count_{(grid_.x - 1) / size_.x + 1, (grid_.y - 1) / size_.y + 1,
               (grid_.z - 1) / size_.z + 1} {}

  [[nodiscard]] constexpr std::uint32_t regions() const noexcept {
    return count_.x * count_.y * count_.z;
  }
  // Precondition of what follows: the region, number and block exist.
  /// The grid of one region.
  [[nodiscard]] Grid grid_of(std::uint32_t region) const noexcept;
  /// The region that holds a block.
  [[nodiscard]] std::uint32_t region_of(std::uint32_t block) const noexcept;
  /// The block index of each block of a region, in the region's order. Throws std::bad_alloc.
  [[nodiscard]] std::vector<std::uint32_t> blocks_of(std::uint32_t region) const;
  /// The block index of block `number` of a region, and the inverse.
  [[nodiscard]] std::uint32_t block_of(std::uint32_t region, std::uint32_t number) const noexcept;
  [[nodiscard]] std::uint32_t number_of(std::uint32_t block) const noexcept;
  /// The place of a region among the regions.
  [[nodiscard]] Grid place_of(std::uint32_t region) const noexcept;
  /// The place of a region's first block, in blocks along each axis.
  [[nodiscard]] Grid first_of(std::uint32_t region) const noexcept;

 private:
  static constexpr Grid one_at_least(Grid grid) noexcept {
    return {grid.x > 0 ? grid.x : 1, grid.y > 0 ? grid.y : 1, grid.z > 0 ? grid.z : 1};
  }
  Grid grid_, size_, count_;
};

/// The regions of a texture in a volume with regions of `size`: boxes of a grid, or runs of x·y·z
/// slots of a pool.
[[nodiscard]] RegionGrid regions_of(const TextureDesc& desc, const Grid& size) noexcept;
/// The description of one region as a texture of its own: packets of the region are made for it.
/// Its layout is atlas_xy_z.
[[nodiscard]] TextureDesc region_texture(const TextureDesc& desc, const Grid& size,
                                         std::uint32_t region) noexcept;

}  // namespace gicodec
