// Ambient occlusion at points on surfaces (Neff et al. §3). Points lie in cells; a hash table of
// buckets finds the cells of each instance of a mesh.
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

/// Kind 6: three texture groups, each over a pool.
/// - "cells": blocks of 7×1×1 points, 4 bytes each (pack_ao_point()).
/// - "buckets": blocks of 8×1×1 entries, 8 bytes each (pack_ao_entry()). A bucket depends on the
///   cells that its entries refer to.
/// - "grid" and "transform": a block of one record per instance (AoGrid, AoTransform).
extern const Kind kAoPoints;

/// A volume of this kind. Each number is 1..kMaxBlocks, else invalid_description. Textures have
/// Tiling::blocks.
[[nodiscard]] Result<VolumeDesc> ao_point_volume(std::uint32_t cells, std::uint32_t buckets,
                                                 std::uint32_t instances);

/// A point, stored in 32 bits (§3.2); 0 is a free place. A point keeps its place, of the cell's
/// seven, while it is in that cell.
struct AoPoint {
  Position place{};                      ///< within its cell, each coordinate 0..1
  std::array<float, 3> normal{0, 0, 1};  ///< unit length, in the instance's space
  std::uint8_t visible = 255;            ///< open share of the hemisphere, in 1/255

  friend bool operator==(const AoPoint&, const AoPoint&) = default;
};

/// Never 0. A value out of range or infinite becomes the nearest in range, NaN becomes 0, and a
/// normal of length 0 becomes +z.
[[nodiscard]] std::uint32_t pack_ao_point(const AoPoint& point) noexcept;
/// Coordinates are stored in steps of 1/32 of the cell: `place` is the centre of the step. nullopt
/// for a free place.
[[nodiscard]] std::optional<AoPoint> unpack_ao_point(std::uint32_t bits) noexcept;
/// The point with another visibility.
[[nodiscard]] constexpr std::uint32_t with_visible(std::uint32_t bits,
                                                   std::uint8_t visible) noexcept {
  return (bits & 0xFFFFFFU) | std::uint32_t{visible} << 24;
}

/// An entry of a bucket: where a cell is stored. 0 is a free entry.
struct AoEntry {
  Grid cell;               ///< coordinates, each below kMaxAoGridSide
  std::uint32_t slot = 0;  ///< in the pool of cells, below 2^24

  friend bool operator==(const AoEntry&, const AoEntry&) = default;
};
/// Precondition: the entry is in range.
[[nodiscard]] std::uint64_t pack_ao_entry(const AoEntry& entry) noexcept;
/// nullopt for a free entry.
[[nodiscard]] std::optional<AoEntry> unpack_ao_entry(std::uint64_t bits) noexcept;

/// An instance's grid of cells, in the instance's space, and its part of the hash table.
struct AoGrid {
  Position origin{};                            ///< corner of cell (0, 0, 0)
  float cell = 1;                               ///< side of a cell
  Grid cells{1, 1, 1};                          ///< each 1..kMaxAoGridSide
  std::uint32_t first_bucket = 0, buckets = 0;  ///< buckets 0: the instance has no points
  float radius = 0;                    ///< of interpolation (equation 2), in the instance's space
  std::uint32_t object = 0, mesh = 0;  ///< the scene's numbers

  friend bool operator==(const AoGrid&, const AoGrid&) = default;
};
inline constexpr std::size_t kAoGridBytes = 44;
/// Floats keep their bits. Precondition: `cells` in range.
void pack_ao_grid(const AoGrid& grid, std::span<std::byte, kAoGridBytes> out) noexcept;
/// Takes any bytes; does not check ranges.
[[nodiscard]] AoGrid unpack_ao_grid(std::span<const std::byte, kAoGridBytes> bytes) noexcept;

/// Transform from the instance's space to the world's: three rows of four, row-major.
using AoTransform = std::array<float, 12>;
inline constexpr std::size_t kAoTransformBytes = 48;

/// Index of a cell's bucket among all: first_bucket + (x + y·Dx·17 + z·Dx·Dy·31) modulo buckets
/// (equation 1). Preconditions: coordinates of the cell are below kMaxAoGridSide, the grid's sides
/// at most that; buckets is not 0.
[[nodiscard]] std::uint64_t ao_bucket(const AoGrid& grid, const Grid& cell) noexcept;

/// Slot of the cell at these coordinates, below `cells`; nullopt if there is none. Searches one
/// bucket. `buckets`: all blocks of that texture, tightly packed. Safe on hostile bytes: an entry
/// out of range counts as free.
[[nodiscard]] std::optional<std::uint32_t> find_ao_cell(const AoGrid& grid, const Grid& cell,
                                                        std::span<const std::byte> buckets,
                                                        std::uint32_t cells) noexcept;

}  // namespace gicodec
