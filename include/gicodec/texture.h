// Textures of blocks: their description, their layout in memory, and views of that memory.
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

/// A number of blocks or records along each axis. Block (x, y, z) has index x + nx·(y + ny·z),
/// whatever the layout.
struct Grid {
  std::uint32_t x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Grid&, const Grid&) = default;
};

/// Records of a block along each axis.
struct BlockShape {
  std::uint8_t x = 1, y = 1, z = 1;
  friend constexpr bool operator==(const BlockShape&, const BlockShape&) = default;
};

/// How the blocks of a texture relate in space.
enum class Space : std::uint8_t {
  grid = 0,  ///< places with neighbours
  pool = 1,  ///< numbered slots without neighbours
};

/// How a texture says which records of a block exist. Missing records are zero. They are not coded,
/// and nothing is predicted from them.
enum class Presence : std::uint8_t {
  all = 0,
  count = 1,  ///< a u16 per block: that many records from the first on exist
  mask = 2,   ///< ⌈records / 8⌉ bytes per block: 1 bit per record, lowest first
  /// Bricks of n³ voxels (n 2, 4 or 8) in a pool, six records along x per voxel. Per block: 8 bytes
  /// of BrickPlace (<gicodec/voxels.h>), then a mask of voxels, padded with zeros to whole bytes.
  /// Requires Model::octree.
  brick = 3,
};

/// What a codec assumes of a texture's blocks. Only native uses it.
enum class Model : std::uint8_t {
  none = 0,  ///< nothing; blocks are coded independently of each other
  /// A record resembles the one at the same place of the blocks at x−1, y−1 and z−1 (probes). Grids
  /// only.
  stacked = 1,
  continuous = 2,  ///< a record resembles its neighbours, also across blocks (tiles); grids only
  /// The order of a block's records means nothing. The canonical order (FORMAT.md, "Sets") takes
  /// fewest bytes; the caller sorts. Requires Presence::all or count, no guard band, full blocks.
  unordered = 3,
  /// A block is a brick of voxels; it refines the brick of the next coarser level around it.
  /// Requires Presence::brick.
  octree = 4,
  /// A block is the light at a grid vertex: a colored_direction() for each hemisphere, around +x,
  /// −x, +y, −y, +z, −z. The sum of direction · (R + G + B) over opposite ones is the same along
  /// all three axes. Requires blocks of 6×1×1 and Presence::all.
  hemispheres = 5,
};

/// Where the tile of block (x, y, z) lies: column, row, slice. A tile is a block with its guard
/// band and padding, as deep as the block.
enum class Tiling : std::uint8_t {
  atlas_xy_z = 0,   ///< column x + nx·y, row z: the DDGI paper's atlas, G3D
  atlas_xz_y = 1,   ///< column x + nx·z, row y
  atlas_x_yz = 2,   ///< column x, row y + ny·z
  slices_xz_y = 3,  ///< column x, row z, slice y: one slice per plane of a y-up volume (RTXGI)
  slices_xy_z = 4,  ///< column x, row y, slice z: a 2D map, a 3D texture, planes of a z-up volume
  blocks = 5,       ///< an array of blocks, each with its own rows and slices
  atlas_yz_x = 6,   ///< column y + ny·z, row x: RTXGI's atlas of a left-handed z-up volume (O3DE)
  slices_yx_z = 7,  ///< column y, row x, slice z: RTXGI's array of such a volume
};
inline constexpr std::uint8_t kTilingCount = 8;

/// The enumerator's name, e.g. "atlas_xy_z"; empty for any other value.
[[nodiscard]] std::string_view to_string(Tiling tiling) noexcept;
/// The inverse; invalid_argument for any other name.
[[nodiscard]] Result<Tiling> tiling_from_string(std::string_view name) noexcept;

/// Where blocks lie in the caller's memory. Packets do not depend on it: a Decoder may use another
/// layout than the encoder. A Client uses the publisher's.
struct Layout {
  constexpr Layout(Tiling tiling_in = Tiling::atlas_xy_z) noexcept  // NOLINT
      : tiling(tiling_in) {}

  Tiling tiling;
  /// Untouched records before and after each block, 0..kMaxPadding, along axes on which a block has
  /// more than one record. Blocks of 4³ stored as 5³ have 0 and 1.
  std::uint8_t pad_before = 0, pad_after = 0;
  Grid slots{};  ///< pools: slots along each axis, x fastest; zeros: one row along x
  friend constexpr bool operator==(const Layout&, const Layout&) = default;
};

inline constexpr std::uint32_t kMaxBlockSide = 64;
inline constexpr std::uint32_t kMaxBlockRecords = 32768;
inline constexpr std::uint32_t kMaxGridSide = 65535;
inline constexpr std::uint32_t kMaxBlocks = 1U << 24;
inline constexpr std::uint8_t kMaxPadding = 8;

/// All that fixes the meaning of a texture's bytes. A plain value. Kinds make them, e.g.
/// <gicodec/probes.h>.
struct TextureDesc {
  Record record;
  Grid grid;         ///< blocks along each axis; pools: {slots, 1, 1}
  BlockShape block;  ///< without guard band
  /// 0: none. 1: a guard band of one record around each block, which is square and of depth 1. Its
  /// records follow from the core's (FORMAT.md, "Guard band rule").
  std::uint8_t guard_band = 0;
  Space space = Space::grid;
  Presence presence = Presence::all;
  Model model = Model::stacked;
  /// The texture's records along each axis, of a grid whose last blocks are not full. Zeros: all
  /// blocks are full. Records beyond these are zero, and with Tiling::slices_xy_z not in memory.
  Grid records{};
  Layout layout{};

  friend constexpr bool operator==(const TextureDesc&, const TextureDesc&) = default;
};

/// A texture over a pool of `slots`: Model::none, Tiling::blocks.
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

/// Size of the texture in memory, in records, guard bands and padding included. Tiling::blocks:
/// `width` and `height` of one block, `slices` of all.
struct Extent {
  std::uint64_t width = 0, height = 0, slices = 0;
  friend constexpr bool operator==(const Extent&, const Extent&) = default;
};

/// Position in memory, in records, of a block's first record, behind the padding: the guard band's
/// first if there is one.
struct BlockOrigin {
  std::uint64_t x = 0, y = 0, slice = 0;
  std::uint32_t block = 0;  ///< Tiling::blocks: the block's index; else 0
};

/// unsupported_format if the record is not valid; invalid_description if another field is out of
/// range or two fields contradict each other; limit_exceeded in a 32-bit program for textures of
/// 256 MiB and more.
Status validate(const TextureDesc& desc) noexcept;
/// Why not, a field first: "guard_band: it is 0 or 1". Empty where validate() is ok. A zero follows
/// the text; static storage.
[[nodiscard]] std::string_view problem(const TextureDesc& desc) noexcept;

// Precondition of what follows: validate(desc) is ok.
[[nodiscard]] std::uint32_t block_count(const TextureDesc& desc) noexcept;
[[nodiscard]] constexpr std::uint32_t record_count(const BlockShape& block) noexcept {
  return std::uint32_t{block.x} * block.y * block.z;
}
/// Bytes of one block's records, tightly packed (x, then y, then z), without guard band.
[[nodiscard]] constexpr std::size_t block_bytes(const TextureDesc& desc) noexcept {
  return std::size_t{record_count(desc.block)} * desc.record.bytes;
}
/// Records per voxel of a brick, one per direction.
inline constexpr unsigned kVoxelDirections = 6;
/// Bytes of presence per block; 0 for Presence::all.
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
[[nodiscard]] std::uint64_t texture_bytes(const TextureDesc& desc) noexcept;  ///< without pitches
/// Precondition: block < block_count(desc).
[[nodiscard]] BlockOrigin block_origin(const TextureDesc& desc, std::uint32_t block) noexcept;
/// Records of a block within the texture, along each axis. Less than its shape only at the end of a
/// grid with `records`. Precondition: block < block_count(desc).
[[nodiscard]] BlockShape block_inside(const TextureDesc& desc, std::uint32_t block) noexcept;

/// A texture in the caller's memory, e.g. a mapped readback buffer, or the part of an atlas that
/// holds one volume. The library touches only records: never the bytes between a row's end and the
/// next pitch, never past `bytes`. Pitches are in bytes; 0 means tightly packed.
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
