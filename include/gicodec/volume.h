// A grid of blocks in the world, and the boxes it is cut into (Stengel et al. §3.4).
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

/// Cells along each axis by which a camera-locked volume has moved, each within ±kMaxScroll.
using Scroll = std::array<std::int32_t, 3>;
inline constexpr std::int32_t kMaxScroll = 1 << 22;

/// What volumes light, so that whoever draws it can tell whether it is theirs.
struct SceneId {
  std::string name = {};       ///< for people; at most 255 bytes of UTF-8, empty if not told
  std::uint64_t geometry = 0;  ///< hash, as the application makes it; 0 if not told
  friend bool operator==(const SceneId&, const SceneId&) = default;
};

/// Where the blocks of a grid stand: cell c at origin + c · spacing, where c runs from scroll to
/// scroll + n − 1 along an axis of n blocks. A cell's block never moves: it stands in the texture
/// at the block with the same remainder, c mod n, so that a volume which scrolls replaces just the
/// planes that enter. Without scrolling, cell and block are the same.
struct VolumeGeometry {
  Grid grid;  ///< of the volume's first set; of a pool its slots, 1 and 1
  Position origin{0, 0, 0};
  Position spacing{1, 1, 1};  ///< positive
  Scroll scroll{0, 0, 0};

  friend bool operator==(const VolumeGeometry&, const VolumeGeometry&) = default;
};

/// invalid_geometry unless the grid has 1..kMaxBlocks blocks, all numbers are finite and in range
/// and every spacing is positive.
Status validate(const VolumeGeometry& geometry) noexcept;

/// Where a block of the grid stands now. Precondition: block is in the grid.
[[nodiscard]] Position block_position(const VolumeGeometry& geometry, std::uint32_t block) noexcept;

/// The blocks in the order in which they stand: x fastest, from the lowest cell of each axis on.
/// Without scrolling 0, 1, 2 and so on. Throws std::bad_alloc.
[[nodiscard]] std::vector<std::uint32_t> blocks_by_cell(const VolumeGeometry& geometry);

/// The scroll that brings the middle of the volume to within half a cell of `viewer`, which must be
/// finite; clamped to the range.
[[nodiscard]] Scroll scroll_to(const VolumeGeometry& geometry, const Position& viewer) noexcept;

/// Blocks that stand elsewhere after scrolling, ascending: the planes that enter. Precondition: the
/// grid is that of a valid VolumeGeometry. Throws std::bad_alloc.
[[nodiscard]] std::vector<std::uint32_t> entering_blocks(Grid grid, const Scroll& from,
                                                         const Scroll& to);

/// A set of blocks: one byte per block of a grid, not 0 for members.
using BlockMask = std::vector<std::uint8_t>;

/// A grid, or a pool, cut into boxes of at most `size` blocks along each axis; those at the far
/// ends may be smaller. Regions count along x, then y, then z; a region's blocks likewise within
/// it.
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
  /// The grid of one region. Below, regions and blocks are those that there are.
  [[nodiscard]] Grid grid_of(std::uint32_t region) const noexcept;
  /// The region that holds a block of the volume.
  [[nodiscard]] std::uint32_t region_of(std::uint32_t block) const noexcept;
  /// The volume's index of each block of a region, in the region's order. Throws std::bad_alloc.
  [[nodiscard]] std::vector<std::uint32_t> blocks_of(std::uint32_t region) const;
  /// One of them, and a block's number in the order of its region.
  [[nodiscard]] std::uint32_t block_of(std::uint32_t region, std::uint32_t number) const noexcept;
  [[nodiscard]] std::uint32_t number_of(std::uint32_t block) const noexcept;
  /// The place of a region's first block.
  [[nodiscard]] Grid first_of(std::uint32_t region) const noexcept;

 private:
  static constexpr Grid one_at_least(Grid grid) noexcept {
    return {grid.x > 0 ? grid.x : 1, grid.y > 0 ? grid.y : 1, grid.z > 0 ? grid.z : 1};
  }
  Grid grid_, size_, count_;
};

/// How a texture's blocks are cut where a volume has regions of that size: into boxes, or the slots
/// of a pool into runs of x·y·z.
[[nodiscard]] RegionGrid regions_of(const TextureDesc& desc, const Grid& size) noexcept;
/// The texture that the packets of one of these regions are made for. In memory it is an
/// atlas_xy_z.
[[nodiscard]] TextureDesc region_texture(const TextureDesc& desc, const Grid& size,
                                         std::uint32_t region) noexcept;

}  // namespace gicodec
