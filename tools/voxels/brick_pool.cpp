#include "brick_pool.h"

#include <algorithm>
#include <cstring>

namespace gicodec::voxels {

std::vector<std::uint64_t> brick_counts(const Octree& octree, BrickShape shape) {
  std::vector<std::uint64_t> counts;
  for (const OctreeLevel& level : octree) {
    std::uint64_t bricks = 0;
    VoxelKey last = 0;
    for (const VoxelKey key : level.keys) {
      const VoxelKey brick = key >> shape.key_bits();
      if (bricks == 0 || brick != last) ++bricks;
      last = brick;
    }
    counts.push_back(bricks);
  }
  return counts;
}

BrickPool::BrickPool(std::uint32_t slots, BrickShape shape, VoxelForm form)
    : slots_(slots),
      shape_(shape),
      code_(form),
      used_(slots),
      bricks_(slots * shape.place_bytes()),
      light_(std::size_t{slots} * shape.voxels() * code_.bytes()) {}

std::uint64_t BrickPool::put(const Octree& octree) {
  std::vector<Brick> wanted;
  std::uint64_t left_out = 0;
  for (std::size_t level = octree.size(); level-- > 0;) {
    const std::vector<VoxelKey>& keys = octree[level].keys;
    for (std::size_t i = 0; i < keys.size();) {
      Brick brick{static_cast<unsigned>(level), keys[i] >> shape_.key_bits(), slots_, i, i};
      while (i < keys.size() && keys[i] >> shape_.key_bits() == brick.key) ++i;
      brick.end = i;
      if (wanted.size() < slots_) {
        wanted.push_back(brick);
      } else {
        ++left_out;
      }
    }
  }
  auto old = held_.begin();
  for (Brick& brick : wanted) {
    for (; old != held_.end() && old->before(brick); ++old) clear(old->slot);
    if (old != held_.end() && old->same(brick)) brick.slot = (old++)->slot;
  }
  for (; old != held_.end(); ++old) clear(old->slot);
  std::vector<Brick*> entering;
  for (Brick& brick : wanted) {
    if (brick.slot == slots_) entering.push_back(&brick);
  }
  std::ranges::sort(entering, [](const Brick* a, const Brick* b) { return a->above(*b); });
  std::uint32_t free = 0;
  for (Brick* const brick : entering) {
    while (used_[free] != 0) ++free;
    used_[free] = 1;
    brick->slot = free;
  }
  for (const Brick& brick : wanted) write(brick, octree[brick.level]);
  held_ = std::move(wanted);
  return left_out;
}

void BrickPool::write(const Brick& brick, const OctreeLevel& level) {
  clear(brick.slot);
  used_[brick.slot] = 1;
  std::byte* const place = &bricks_[brick.slot * shape_.place_bytes()];
  std::byte* const mask = place + kBrickPlaceBytes;
  std::byte* const light = &light_[std::size_t{brick.slot} * shape_.voxels() * code_.bytes()];
  pack_brick_place({static_cast<std::uint8_t>(brick.level), morton_cell(brick.key)},
                   std::span<std::byte, kBrickPlaceBytes>(place, kBrickPlaceBytes));
  for (std::size_t i = brick.begin; i < brick.end; ++i) {
    const unsigned bit = shape_.bit_of(morton_cell(level.keys[i]));
    mask[bit / 8] |= std::byte{1} << (bit % 8);
    std::memcpy(light + bit * code_.bytes(), &level.records[i * code_.bytes()], code_.bytes());
  }
}

void BrickPool::clear(std::uint32_t slot) {
  used_[slot] = 0;
  const auto zero = [slot](std::vector<std::byte>& texture, std::size_t block) {
    std::fill_n(texture.begin() + static_cast<std::ptrdiff_t>(slot * block), block, std::byte{0});
  };
  zero(bricks_, shape_.place_bytes());
  zero(light_, shape_.voxels() * code_.bytes());
}

}  // namespace gicodec::voxels
