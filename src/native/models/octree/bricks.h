// Bricks of voxels by their places, and what is known around a voxel (docs/native/octree.md).
#pragma once

#include "base/memory.h"
#include "native/models/light/known_lights.h"
#include "native/models/light/light_numbers.h"

#include <gicodec/backend.h>

#include <span>

namespace gicodec::native {

struct Update;

/// A brick in the order of coding: coarser levels first, then by place (Morton).
struct PlacedBrick {
  std::uint64_t order = 0;
  std::uint32_t at = 0;  ///< position in the update, or block
  friend constexpr bool operator<(const PlacedBrick& a, const PlacedBrick& b) noexcept {
    return a.order != b.order ? a.order < b.order : a.at < b.at;
  }
};

/// Bricks that receivers hold and the update does not list, in that order.
void find_held_bricks(const Update& u, Vector<PlacedBrick>& out);

/// The bricks of a chunk. Memory of one thread.
class Bricks {
 public:
  void reset(const Update& u, std::span<const std::uint32_t> positions);
  /// Goes to the i-th brick in the order of coding; its position. `records`: those of all
  /// positions, as far as they were coded.
  std::uint32_t enter(const Update& u, const BlockTable& records, std::size_t i);

  // Of the voxels of that brick, in the order of coding (Morton).
  [[nodiscard]] unsigned voxels() const { return side_ * side_ * side_; }
  [[nodiscard]] bool exists(unsigned m) const;
  /// Where its records are in the block.
  [[nodiscard]] std::size_t offset(unsigned m) const;
  /// Its light in the mirror; empty if there was none.
  [[nodiscard]] std::span<const std::byte> previous(unsigned m) const;
  /// With `has_previous` only voxels that have previous ones count.
  [[nodiscard]] KnownLights around(unsigned m, bool has_previous) const;
  /// The occupancy of a voxel among the siblings that are coded.
  void set_occupancy(unsigned m, LightOccupancy light) {
    occupancy_[m % KnownLights::kChildren] = light;
  }
  [[nodiscard]] KnownLights::Siblings siblings(unsigned m) const;

 private:
  static constexpr unsigned kAround = 27, kHere = 13;
  struct Brick {
    const std::byte *now = nullptr, *mask = nullptr;
    const std::byte *previous = nullptr, *previous_mask = nullptr;  ///< at the same place
  };
  [[nodiscard]] Brick listed(const Update& u, const BlockTable& records,
                             std::uint32_t position) const;
  /// One that is known before the i-th.
  [[nodiscard]] Brick find(const Update& u, const BlockTable& records, std::uint64_t order,
                           std::size_t i) const;
  [[nodiscard]] KnownLights::Neighbour other(const Brick& brick, unsigned voxel,
                                             std::uint32_t distance) const;
  /// One of the brick that is coded, at squared `distance` from one of `siblings`.
  [[nodiscard]] KnownLights::Neighbour own(unsigned m, unsigned siblings,
                                           std::uint32_t distance) const;

  unsigned side_ = 0;
  std::size_t voxel_bytes_ = 0;
  LightEncoding encoding_{Record{}};
  Vector<PlacedBrick> bricks_;
  // Of the brick that is coded.
  std::array<Brick, kAround> around_{};
  Brick parent_{};
  std::array<LightOccupancy, KnownLights::kChildren> occupancy_{};
  std::array<unsigned, 3> parent_at_{};  ///< the parent of its first voxel, in that brick
};

}  // namespace gicodec::native
