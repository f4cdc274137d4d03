// Cells and buckets of all instances as they are sent (Neff et al. §3.2): what is written changes,
// everything else stays as it is.
#pragma once

#include "ddgi/vec.h"

#include <gicodec/ao_points.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gicodec::ao {

/// Where a place of an instance's space is in its grid; nothing if it is outside, or not finite.
struct GridPlace {
  Grid cell;
  Position within{};  ///< the cell, each 0..1
};
[[nodiscard]] std::optional<GridPlace> place_in(const AoGrid& grid, ddgi::Vec3 position);

class PointMemory {
 public:
  using Cell = std::array<std::uint32_t, kAoCellPoints>;
  using Bucket = std::array<std::uint64_t, kAoBucketEntries>;

  /// Gives the grids their parts of the buckets.
  PointMemory(std::vector<AoGrid> grids, std::uint32_t cells);

  /// A place for a point of 32 bits in a cell of an instance; nothing, which is counted, where the
  /// cell, its bucket or the pool is full. Places are numbers: cell slot · 7 + place in the cell.
  std::optional<std::uint32_t> insert(std::size_t instance, const Grid& cell, std::uint32_t bits);
  /// A point in the same place.
  void write(std::uint32_t place, std::uint32_t bits) {
    cells_[place / kAoCellPoints][place % kAoCellPoints] = bits;
  }
  [[nodiscard]] std::uint32_t read(std::uint32_t place) const {
    return cells_[place / kAoCellPoints][place % kAoCellPoints];
  }
  /// Frees the place, and the cell with its last point.
  void remove(std::size_t instance, const Grid& cell, std::uint32_t place);

  [[nodiscard]] std::span<const AoGrid> grids() const { return grids_; }
  [[nodiscard]] std::span<const Cell> cells() const { return cells_; }
  [[nodiscard]] std::span<const Bucket> buckets() const { return buckets_; }

  struct Statistics {
    std::uint64_t points = 0, cells = 0;  ///< at present
    /// Points that found no place since the beginning.
    std::uint64_t full_cells = 0, full_buckets = 0, full_pool = 0;
    [[nodiscard]] std::uint64_t overflow() const { return full_cells + full_buckets + full_pool; }
  };
  [[nodiscard]] const Statistics& statistics() const { return statistics_; }

 private:
  std::vector<AoGrid> grids_;
  std::vector<Cell> cells_;
  std::vector<Bucket> buckets_;
  std::vector<std::uint32_t> freed_;  ///< slots of cells, the last one is taken first
  std::uint32_t fresh_ = 0;           ///< slots from here on were never taken
  Statistics statistics_;
};

}  // namespace gicodec::ao
