// Points of ambient occlusion on surfaces (Neff et al. §3): points in cells, cells found by a hash
// table of buckets for each instance of a mesh.
#pragma once

#include <gicodec/api.h>
#include <gicodec/kind.h>
#include <gicodec/texture.h>
#include <gicodec/volume.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace GICODEC_API gicodec {

inline constexpr std::uint8_t kKindAoPoints = 6;

inline constexpr std::size_t kAoCellPoints = 7;
inline constexpr std::size_t kAoBucketEntries = 8;
inline constexpr std::uint32_t kMaxAoGridSide = 8192;  ///< cells of an instance along an axis

/// Kind 6, three sets: "cells", a pool of blocks of 7×1×1 points of 4 bytes; "buckets", a pool of
/// blocks of 8×1×1 entries of 8 bytes, which name the cells that they refer to; "grid" and
/// "transform", a pool of instances, each with a texture of its own way.
extern const Kind kAoPoints;

/// Each number is 1..kMaxBlocks; else invalid_description. In memory each texture is an array of
/// blocks.
[[nodiscard]] Result<VolumeDesc> ao_point_volume(std::uint32_t cells, std::uint32_t buckets,
                                                 std::uint32_t instances);

/// A point as 32 bits (§3.2). Zero is free; a point stays the same one of its cell's seven while it
/// is in that cell.
struct AoPoint {
  Position place{};                      ///< within its cell, each 0..1
  std::array<float, 3> normal{0, 0, 1};  ///< unit length, of the instance's space
  std::uint8_t visible = 255;            ///< share of the hemisphere that is open, of 255

  friend bool operator==(const AoPoint&, const AoPoint&) = default;
};

/// Never 0. What is out of range or not finite is packed as the nearest that is in range, NaN as 0;
/// a normal of no direction as +z.
[[nodiscard]] std::uint32_t pack_ao_point(const AoPoint& point) noexcept;
/// The centre of the place's 1/32; nothing for a free place, whatever its other bits are.
[[nodiscard]] std::optional<AoPoint> unpack_ao_point(std::uint32_t bits) noexcept;
/// The same point, with another visibility.
[[nodiscard]] constexpr std::uint32_t with_visible(std::uint32_t bits,
                                                   std::uint8_t visible) noexcept {
  return (bits & 0xFFFFFFU) | std::uint32_t{visible} << 24;
}

/// Where to find a cell. An entry of 0 is free.
struct AoEntry {
  Grid cell;               ///< its coordinates, each below kMaxAoGridSide
  std::uint32_t slot = 0;  ///< of the pool of cells, below 2^24

  friend bool operator==(const AoEntry&, const AoEntry&) = default;
};
/// Precondition: the ranges above.
[[nodiscard]] std::uint64_t pack_ao_entry(const AoEntry& entry) noexcept;
/// Nothing for a free entry, whatever its other bits are.
[[nodiscard]] std::optional<AoEntry> unpack_ao_entry(std::uint64_t bits) noexcept;

/// An instance's grid of cells, in its own space, and its part of the hash table.
struct AoGrid {
  Position origin{};                            ///< corner of cell (0, 0, 0)
  float cell = 1;                               ///< side of a cell
  Grid cells{1, 1, 1};                          ///< each 1..kMaxAoGridSide
  std::uint32_t first_bucket = 0, buckets = 0;  ///< none: it has no points
  float radius = 0;                             ///< of interpolation (equation 2)
  std::uint32_t object = 0, mesh = 0;           ///< by the scene's numbers

  friend bool operator==(const AoGrid&, const AoGrid&) = default;
};
inline constexpr std::size_t kAoGridBytes = 44;
/// Precondition: cells of at most kMaxAoGridSide. Floats keep their bits.
void pack_ao_grid(const AoGrid& grid, std::span<std::byte, kAoGridBytes> out) noexcept;
/// Of any bytes; ranges are not looked at.
[[nodiscard]] AoGrid unpack_ao_grid(std::span<const std::byte, kAoGridBytes> bytes) noexcept;

/// From the instance's space to the world's: three rows of four.
using AoTransform = std::array<float, 12>;
inline constexpr std::size_t kAoTransformBytes = 48;

/// The bucket of a cell among all: first_bucket + (x + y·Dx·17 + z·Dx·Dy·31) modulo buckets
/// (equation 1). Preconditions: the cell is below kMaxAoGridSide, and so are the grid's sides;
/// buckets is not 0.
[[nodiscard]] std::uint64_t ao_bucket(const AoGrid& grid, const Grid& cell) noexcept;

/// Slot of the cell at these coordinates, nothing if there is none. Looks at one bucket. Grid and
/// buckets may hold anything: what is out of range is not there, and the slot is below `cells`.
/// `buckets`: all blocks of the texture, one after the other.
[[nodiscard]] std::optional<std::uint32_t> find_ao_cell(const AoGrid& grid, const Grid& cell,
                                                        std::span<const std::byte> buckets,
                                                        std::uint32_t cells) noexcept;

}  // namespace gicodec
