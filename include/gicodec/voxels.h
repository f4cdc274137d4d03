// Voxels (Crassin et al. §4.1): bricks of a sparse octree. Each voxel that is not empty has light
// from six directions.
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
  halves = 1,  ///< R16G16B16A16_SFLOAT; alpha: the share that the voxel covers, seen that way
};

/// Kind 7: one group of two bundled textures over a pool of bricks.
/// - "bricks": a BrickPlace and a mask of the voxels that exist. A slot with an empty mask is free;
///   of slots with the same place the lowest counts.
/// - "light": blocks of 6·side × side × side records, the six of a voxel (kVoxelDirections) side by
///   side: irradiance over π on faces towards +x, −x, +y, −y, +z, −z. Zero: no surface faces that
///   way. An unlit face has the least value that is not zero.
///
/// Coarser levels are sent first. VolumeGeometry::grid is {bricks, 1, 1}; its spacing is equal
/// along all axes.
extern const Kind kVoxels;

/// A volume of `bricks` (1..kMaxBlocks) of side³ voxels, side 4 or 8; else invalid_description.
/// Textures have Tiling::blocks.
[[nodiscard]] Result<VolumeDesc> voxel_volume(std::uint32_t bricks, std::uint8_t side = 4,
                                              VoxelForm form = VoxelForm::shared_exponent);
/// The form of a "light" texture with that record; unsupported_format for any other record.
[[nodiscard]] Result<VoxelForm> voxel_form(const Record& record) noexcept;

inline constexpr unsigned kMaxBrickLevel = 18;
inline constexpr std::uint32_t kMaxBrickSide = 1U << 18;  ///< bricks along an axis

/// Where a brick stands. Its first voxel is side·(x, y, z) of its level. Level 0 is the finest. A
/// voxel of level l + 1 covers 2³ voxels of level l; its light of a direction is the mean of those
/// of theirs that are not zero. Voxel (0, 0, 0) of each level begins at the volume's origin; voxels
/// of level 0 are `spacing` wide. In a mask voxel (x, y, z) of the brick is bit x + side·(y +
/// side·z).
struct BrickPlace {
  std::uint8_t level = 0;             ///< 0..kMaxBrickLevel
  std::array<std::uint32_t, 3> at{};  ///< x, y, z in bricks, each below kMaxBrickSide

  friend constexpr bool operator==(const BrickPlace&, const BrickPlace&) = default;
};
inline constexpr std::size_t kBrickPlaceBytes = 8;
/// A place is stored as a u64: the Morton key of the coordinates, and the level from this bit on.
inline constexpr unsigned kBrickLevelShift = 56;

/// The Morton key interleaves the bits of the coordinates, x lowest: the parent's key is this >> 3,
/// for bricks as for voxels. Precondition: each coordinate is below 2^21.
[[nodiscard]] std::uint64_t morton_key(const std::array<std::uint32_t, 3>& at) noexcept;
/// The inverse.
[[nodiscard]] std::array<std::uint32_t, 3> morton_cell(std::uint64_t key) noexcept;

/// Writes the 8 bytes that precede the mask. Precondition: the place is in range.
void pack_brick_place(const BrickPlace& place, std::span<std::byte, kBrickPlaceBytes> out) noexcept;
/// Takes any bytes; drops bits out of range.
[[nodiscard]] BrickPlace unpack_brick_place(
    std::span<const std::byte, kBrickPlaceBytes> bytes) noexcept;

}  // namespace gicodec
