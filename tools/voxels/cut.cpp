#include "cut.h"

#include "voxel_field.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gicodec::voxels {
namespace {

class Cut {
 public:
  Cut(const BrickIndex& index, BrickShape shape, const VolumeGeometry& geometry, BlockMask& mask)
      : index_(index), shape_(shape), geometry_(geometry), mask_(mask) {}

  /// Bricks of one level within a voxel of a point.
  void add(Vec3 point, unsigned level) {
    const std::array<double, 3> p{point.x, point.y, point.z};
    Cell lo{}, hi{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double voxel = std::ldexp((p[axis] - geometry_.origin[axis]) / geometry_.spacing[0],
                                      -static_cast<int>(level));
      const double side = shape_.side;
      constexpr double kLast = kMaxBrickSide - 1;
      const double first = std::floor((voxel - 1) / side), last = std::floor((voxel + 1) / side);
      if (!(last >= 0 && first <= kLast)) return;
      lo[axis] = static_cast<std::uint32_t>(std::max(first, 0.0));
      hi[axis] = static_cast<std::uint32_t>(std::min(last, kLast));
    }
    for (std::uint32_t z = lo[2]; z <= hi[2]; ++z) {
      for (std::uint32_t y = lo[1]; y <= hi[1]; ++y) {
        for (std::uint32_t x = lo[0]; x <= hi[0]; ++x) {
          if (const auto slot = index_.find(level, {x, y, z})) mask_[*slot] = 1;
        }
      }
    }
  }

 private:
  const BrickIndex& index_;
  BrickShape shape_;
  const VolumeGeometry& geometry_;
  BlockMask& mask_;
};

/// The lowest level all of which is sent, as those above: all but the coarsest while they have a
/// small share of the bricks together.
unsigned known_everywhere(const BrickIndex& index) {
  constexpr std::size_t kShare = 16;
  std::array<std::size_t, kMaxBrickLevel + 1> bricks{};
  for (const BrickIndex::Entry& entry : index.entries()) ++bricks[BrickIndex::level(entry)];
  unsigned level = index.coarsest();
  std::size_t sum = bricks[level];
  while (level > 0 && (sum += bricks[level - 1]) * kShare <= index.entries().size()) --level;
  return level;
}

}  // namespace

BlockMask cut(std::span<const std::byte> bricks, BrickShape shape, const VolumeGeometry& geometry,
              const CutView& view, std::span<const Vec3> points) {
  BlockMask mask(bricks.size() / shape.place_bytes());
  const BrickIndex index(bricks, shape);
  const unsigned everywhere = known_everywhere(index);
  for (const BrickIndex::Entry& entry : index.entries()) {
    if (BrickIndex::level(entry) >= everywhere) mask[entry.slot] = 1;
  }
  Cut cut(index, shape, geometry, mask);
  for (const Vec3 point : points) {
    const double width = double{length(point - view.eye)} * view.pixel * view.detail;
    const auto finest = static_cast<unsigned>(level_of(width, geometry.spacing[0]));
    // What is within a voxel of a point is within a coarser voxel of it too, so this is closed.
    for (unsigned level = finest; level < everywhere; ++level) cut.add(point, level);
  }
  return mask;
}

void ChangedSlots::add(std::span<const std::byte> bricks, BrickShape shape) {
  const std::size_t size = shape.place_bytes();
  before_.resize(bricks.size() / size);
  slots_.resize(before_.size());
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    const auto now = brick_in(bricks.subspan(slot * size, size));
    if (before_[slot] && before_[slot] != now) slots_[slot] = 1;
    before_[slot] = now;
  }
}

}  // namespace gicodec::voxels
