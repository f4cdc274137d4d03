// Textures of blocks: what they are made of, where they stand in memory, views of that memory.
#pragma once

#include <gicodec/api.h>
#include <gicodec/record.h>
#include <gicodec/status.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace GICODEC_API gicodec {

/// Blocks, or records, along each axis. Block index = x + nx·(y + ny·z), wherever blocks stand.
struct Grid {
  std::uint32_t x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Grid&, const Grid&) = default;
};

/// Records of a block along each axis.
struct BlockShape {
  std::uint8_t x = 1, y = 1, z = 1;
  friend constexpr bool operator==(const BlockShape&, const BlockShape&) = default;
};

enum class Space : std::uint8_t {
  grid = 0,  ///< blocks have neighbours
  pool = 1,  ///< slots without
};

/// Which records of a block exist. Those that do not are zero, are not coded, and nothing is
/// predicted from them.
enum class Presence : std::uint8_t {
  all = 0,
  count = 1,  ///< the first so many: a u16 per block
  mask = 2,   ///< those whose bit is set: ⌈records / 8⌉ bytes per block, lowest bit first
  /// Of a pool of bricks of n³ voxels (n 2, 4 or 8), six records along x each: 8 bytes that say
  /// where the brick stands (BrickPlace, <gicodec/voxels.h>), then a mask of voxels, and zeros up
  /// to whole bytes. With Model::octree and never without.
  brick = 3,
};

/// What a codec assumes of a texture's blocks. Only native makes use of it.
enum class Model : std::uint8_t {
  none = 0,  ///< nothing: a block says nothing of others
  /// A record resembles the one at the same place of the blocks at x−1, y−1 and z−1 (probes). Grids
  /// only.
  stacked = 1,
  continuous = 2,  ///< a record resembles those next to it, also across edges (tiles). Grids only.
  /// A block is a set: the order of its records means nothing. Whoever publishes it puts them in
  /// the canonical order (FORMAT.md, "Sets"), else it costs more. No mask, no guard band, full
  /// blocks.
  unordered = 3,
  /// A block is a brick of voxels that refines the brick of the next level around it. With
  /// Presence::brick and never without.
  octree = 4,
  /// A block is light at a vertex of a grid, over the hemispheres around +x, −x, +y, −y, +z, −z: a
  /// colored_direction() each. Opposite ones sum up to the same. Blocks of 6×1×1, all records
  /// exist.
  hemispheres = 5,
};

/// Where the tile of block (x, y, z) stands: column, row, slice. A tile is as deep as its block.
enum class Tiling : std::uint8_t {
  atlas_xy_z = 0,   ///< column x + nx·y, row z: the DDGI paper's atlas, G3D
  atlas_xz_y = 1,   ///< column x + nx·z, row y
  atlas_x_yz = 2,   ///< column x, row y + ny·z
  slices_xz_y = 3,  ///< column x, row z, slice y: one slice per plane of a y-up volume (RTXGI)
  slices_xy_z = 4,  ///< column x, row y, slice z: a 2D map, a 3D texture, planes of a z-up volume
  blocks = 5,       ///< an array of blocks, each with rows and slices of its own
  atlas_yz_x = 6,   ///< column y + ny·z, row x: RTXGI's atlas of a left-handed z-up volume (O3DE)
  slices_yx_z = 7,  ///< column y, row x, slice z: RTXGI's array of such a volume
};
inline constexpr std::uint8_t kTilingCount = 8;

/// "atlas_xy_z" and so on; empty for a value that is no tiling.
[[nodiscard]] std::string_view to_string(Tiling tiling) noexcept;
[[nodiscard]] Result<Tiling> tiling_from_string(std::string_view name) noexcept;

/// Where blocks stand in the caller's memory. No part of what is coded: whoever has a Decoder
/// chooses another as he likes. A Client is told the publisher's, and has its textures in that.
struct Layout {
  constexpr Layout(Tiling tiling_in = Tiling::atlas_xy_z) noexcept  // NOLINT
      : tiling(tiling_in) {}

  Tiling tiling;
  /// Records before and after each block, along axes on which it has more than one, which are
  /// never touched: 5³ around 4³ is 0 and 1.
  std::uint8_t pad_before = 0, pad_after = 0;
  Grid slots{};  ///< pools: slots along each axis, x fastest; zeros: all along x
  friend constexpr bool operator==(const Layout&, const Layout&) = default;
};

inline constexpr std::uint32_t kMaxBlockSide = 64;
inline constexpr std::uint32_t kMaxBlockRecords = 32768;
inline constexpr std::uint32_t kMaxGridSide = 65535;
inline constexpr std::uint32_t kMaxBlocks = 1U << 24;
inline constexpr std::uint8_t kMaxPadding = 8;

/// Everything that fixes the meaning of a texture's bytes. A plain value; kinds make them
/// (<gicodec/probes.h> and others).
struct TextureDesc {
  Record record;
  Grid grid;         ///< blocks; of a pool its slots along x, and 1, 1
  BlockShape block;  ///< without guard band
  /// Derived records: 0 none; 1 a guard band around square blocks of depth 1, by the octahedral
  /// rule (FORMAT.md, "Guard band rule").
  std::uint8_t guard_band = 0;
  Space space = Space::grid;
  Presence presence = Presence::all;
  Model model = Model::stacked;
  /// Records along each axis where a grid's last blocks are not full; zeros: all are. What a block
  /// has beyond is zero, and with Tiling::slices_xy_z not in memory.
  Grid records{};
  Layout layout{};

  friend constexpr bool operator==(const TextureDesc&, const TextureDesc&) = default;
};

/// A texture over a pool of that many slots; in memory an array of blocks.
[[nodiscard]] inline TextureDesc pool_texture(const Record& record, std::uint32_t slots,
                                              BlockShape block) noexcept {
  TextureDesc desc;
  desc.record = record;
  desc.grid = {slots, 1, 1};
  desc.block = block;
  desc.space = Space::pool;
  desc.model = Model::none;
  desc.layout = Tiling::blocks;
  return desc;
}

/// Extent of the texture in records, padding included. Tiling::blocks: of one block, times slices.
struct Extent {
  std::uint64_t width = 0, height = 0, slices = 0;
  friend constexpr bool operator==(const Extent&, const Extent&) = default;
};

/// Position of a block's first record, after padding, guard band included.
struct BlockOrigin {
  std::uint64_t x = 0, y = 0, slice = 0;
  std::uint32_t block = 0;  ///< with Tiling::blocks its index, else 0
};

/// unsupported_format for a record that is not valid, invalid_description if another field is out
/// of range or two contradict each other.
Status validate(const TextureDesc& desc) noexcept;

// The following need a desc that validate() accepts.
[[nodiscard]] std::uint32_t block_count(const TextureDesc& desc) noexcept;
[[nodiscard]] constexpr std::uint32_t record_count(const BlockShape& block) noexcept {
  return std::uint32_t{block.x} * block.y * block.z;
}
/// Of one block, without guard band, tightly packed: rows along x, then y, then z.
[[nodiscard]] constexpr std::size_t block_bytes(const TextureDesc& desc) noexcept {
  return std::size_t{record_count(desc.block)} * desc.record.bytes;
}
/// Records of a voxel of a brick.
inline constexpr unsigned kVoxelDirections = 6;
/// Bytes per block that say which records exist; 0 for Presence::all.
[[nodiscard]] constexpr std::size_t presence_bytes(const TextureDesc& desc) noexcept {
  switch (desc.presence) {
    case Presence::all:
      return 0;
    case Presence::count:
      return 2;
    case Presence::mask:
      return (record_count(desc.block) + 7) / 8;
    case Presence::brick:
      return 8 + (record_count(desc.block) / kVoxelDirections + 7) / 8;
  }
  return 0;
}
[[nodiscard]] Extent extent(const TextureDesc& desc) noexcept;
[[nodiscard]] std::uint64_t texture_bytes(const TextureDesc& desc) noexcept;  ///< tightly packed
/// Precondition: block < block_count(desc).
[[nodiscard]] BlockOrigin block_origin(const TextureDesc& desc, std::uint32_t block) noexcept;
/// The records of a block that are in the volume; fewer than its shape only where `records` ends.
[[nodiscard]] BlockShape block_inside(const TextureDesc& desc, std::uint32_t block) noexcept;

/// A texture in the caller's memory, e.g. a mapped readback buffer, or the part of an atlas that
/// holds one volume. Only the records themselves are touched: never the bytes between a row's end
/// and the next pitch, never past `bytes`. A pitch of 0 means tightly packed.
template <typename Byte>
struct BasicTextureView {
  std::span<Byte> bytes;
  std::size_t row_pitch = 0;    ///< bytes from a row to the next
  std::size_t slice_pitch = 0;  ///< bytes from a slice to the next
  std::size_t block_pitch = 0;  ///< Tiling::blocks: bytes from a block to the next
};
using TextureView = BasicTextureView<std::byte>;

struct ConstTextureView : BasicTextureView<const std::byte> {
  constexpr ConstTextureView() = default;
  constexpr ConstTextureView(std::span<const std::byte> bytes_in,  // NOLINT(*-explicit-constructor)
                             std::size_t row_pitch_in = 0, std::size_t slice_pitch_in = 0,
                             std::size_t block_pitch_in = 0)
      : BasicTextureView{bytes_in, row_pitch_in, slice_pitch_in, block_pitch_in} {}
  constexpr ConstTextureView(const TextureView& view)  // NOLINT(google-explicit-constructor)
      : BasicTextureView{view.bytes, view.row_pitch, view.slice_pitch, view.block_pitch} {}
};

}  // namespace gicodec
