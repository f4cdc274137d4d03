#include "point_memory.h"

#include <algorithm>
#include <cmath>

namespace gicodec::ao {

std::optional<GridPlace> place_in(const AoGrid& grid, ddgi::Vec3 position) {
  const std::array<float, 3> at{position.x, position.y, position.z};
  const std::array<std::uint32_t, 3> sides{grid.cells.x, grid.cells.y, grid.cells.z};
  std::array<std::uint32_t, 3> cell{};
  GridPlace place;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float c = (at[axis] - grid.origin[axis]) / grid.cell;
    if (!(c >= 0 && c < static_cast<float>(sides[axis]))) return std::nullopt;
    cell[axis] = static_cast<std::uint32_t>(c);
    place.within[axis] = c - std::floor(c);
  }
  place.cell = {cell[0], cell[1], cell[2]};
  return place;
}

PointMemory::PointMemory(std::vector<AoGrid> grids, std::uint32_t cells)
    : grids_(std::move(grids)), cells_(cells) {
  std::uint32_t buckets = 0;
  for (AoGrid& grid : grids_) {
    grid.first_bucket = buckets;
    buckets += grid.buckets;
  }
  buckets_.resize(buckets);
}

std::optional<std::uint32_t> PointMemory::insert(std::size_t instance, const Grid& cell,
                                                 std::uint32_t bits) {
  Bucket& bucket = buckets_[ao_bucket(grids_[instance], cell)];
  std::uint64_t* free = nullptr;
  for (std::uint64_t& word : bucket) {
    const auto entry = unpack_ao_entry(word);
    if (!entry && free == nullptr) free = &word;
    if (!entry || !(entry->cell == cell)) continue;
    Cell& points = cells_[entry->slot];
    const auto place = std::ranges::find(points, 0U);
    if (place == points.end()) {
      ++statistics_.full_cells;
      return std::nullopt;
    }
    *place = bits;
    ++statistics_.points;
    return static_cast<std::uint32_t>(entry->slot * kAoCellPoints +
                                      static_cast<std::size_t>(place - points.begin()));
  }
  if (free == nullptr) {
    ++statistics_.full_buckets;
    return std::nullopt;
  }
  std::uint32_t slot = fresh_;
  if (!freed_.empty()) {
    slot = freed_.back();
    freed_.pop_back();
  } else if (fresh_ < cells_.size()) {
    ++fresh_;
  } else {
    ++statistics_.full_pool;
    return std::nullopt;
  }
  *free = pack_ao_entry({cell, slot});
  cells_[slot].front() = bits;
  ++statistics_.points, ++statistics_.cells;
  return static_cast<std::uint32_t>(slot * kAoCellPoints);
}

void PointMemory::remove(std::size_t instance, const Grid& cell, std::uint32_t place) {
  const auto slot = static_cast<std::uint32_t>(place / kAoCellPoints);
  write(place, 0);
  --statistics_.points;
  if (std::ranges::any_of(cells_[slot], [](std::uint32_t bits) { return bits != 0; })) return;
  Bucket& bucket = buckets_[ao_bucket(grids_[instance], cell)];
  std::ranges::replace(bucket, pack_ao_entry({cell, slot}), std::uint64_t{0});
  freed_.push_back(slot);
  --statistics_.cells;
}

}  // namespace gicodec::ao
