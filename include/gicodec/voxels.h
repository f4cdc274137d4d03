// Voxels (Crassin et al. §4.1): bricks of a sparse octree, with light from six directions at each
// voxel that has something in it.
#pragma once

#include <gicodec/api.h>
#include <gicodec/kind.h>
#include <gicodec/texture.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace GICODEC_API gicodec {

inline constexpr std::uint8_t kKindVoxels = 7;

/// How the light of one direction is stored.
enum class VoxelForm : std::uint8_t {
  shared_exponent = 0,  ///< E5B9G9R9_UFLOAT_PACK32
  halves = 1,           ///< R16G16B16A16_SFLOAT; alpha is how much the voxel covers, seen that way
};

/// Kind 7: one set, a pool of bricks, of two textures that travel together: "bricks" (BrickPlace,
/// and a mask of the voxels that exist) and "light", blocks of 6·side × side × side records: those
/// of a voxel (kVoxelDirections) are side by side, irradiance over π on faces towards +x, −x, +y,
/// −y, +z, −z. Zero says that nothing looks there; a face without any light takes the least value
/// that is not zero. A slot whose mask is zero is free; of slots with one place the lowest counts.
/// Coarser levels come first. VolumeGeometry::grid is {bricks, 1, 1}, its spacing one for all axes.
extern const Kind kVoxels;

/// A pool of that many bricks (1..kMaxBlocks) of 4³ or 8³ voxels; else invalid_description. In
/// memory each texture is an array of blocks.
[[nodiscard]] Result<VolumeDesc> voxel_volume(std::uint32_t bricks, std::uint8_t side = 4,
                                              VoxelForm form = VoxelForm::shared_exponent);
/// The form of a "light" texture by its record; unsupported_format if it is none.
[[nodiscard]] Result<VoxelForm> voxel_form(const Record& record) noexcept;

inline constexpr unsigned kMaxBrickLevel = 18;
inline constexpr std::uint32_t kMaxBrickSide = 1U << 18;  ///< bricks along an axis

/// Where a brick stands: it has the voxels from side·(x, y, z) on of its level. Level 0 is the
/// finest; a voxel of level l + 1 is the 2³ of level l under it, and its light of a direction the
/// mean of those that are not zero. Voxel (0, 0, 0) of each level begins at the volume's origin;
/// those of level 0 are `spacing` wide. In a mask the bit of a voxel is x + side·(y + side·z).
struct BrickPlace {
  std::uint8_t level = 0;             ///< to kMaxBrickLevel
  std::array<std::uint32_t, 3> at{};  ///< each below kMaxBrickSide

  friend constexpr bool operator==(const BrickPlace&, const BrickPlace&) = default;
};
inline constexpr std::size_t kBrickPlaceBytes = 8;
/// They are a u64: Morton key of the coordinates, and from this bit on the level.
inline constexpr unsigned kBrickLevelShift = 56;

/// Bits of coordinates in turn, x lowest (Morton): that of the parent is this >> 3, in bricks as in
/// voxels. Precondition: each below 2^21.
[[nodiscard]] std::uint64_t morton_key(const std::array<std::uint32_t, 3>& at) noexcept;
[[nodiscard]] std::array<std::uint32_t, 3> morton_cell(std::uint64_t key) noexcept;

/// As it is before the mask. Precondition: the ranges above.
void pack_brick_place(const BrickPlace& place, std::span<std::byte, kBrickPlaceBytes> out) noexcept;
/// Of any bytes; what is out of range is cut.
[[nodiscard]] BrickPlace unpack_brick_place(
    std::span<const std::byte, kBrickPlaceBytes> bytes) noexcept;

}  // namespace gicodec
