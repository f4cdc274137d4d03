// Levels and their means.
#include "octrees.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace gicodec::voxels {
namespace {

TEST(Octree, OneBrickHoldsTheCoarsestLevel) {
  EXPECT_EQ(levels_of({1, 1, 1}, 4), 1U);
  EXPECT_EQ(levels_of({4, 4, 4}, 4), 1U);
  EXPECT_EQ(levels_of({4, 5, 4}, 4), 2U);
  EXPECT_EQ(levels_of({8, 1, 64}, 8), 4U);
  EXPECT_EQ(levels_of({8, 1, 65}, 8), 5U);
  EXPECT_EQ(levels_of({kMaxCells, 1, 1}, 4), kMaxBrickLevel + 1);
}

RC_GTEST_PROP(Octree, ParentsAreTheMeansOfTheChildrenThatExist, (std::uint32_t seed, bool halves)) {
  const VoxelForm form = test::kForms[halves ? 1 : 0];
  const VoxelCode code(form);
  const Octree octree = test::random_octree(5 + seed % 20, 0.02F, seed, 4, form);
  for (std::size_t level = 1; level < octree.size(); ++level) {
    std::map<VoxelKey, std::vector<std::pair<unsigned, Voxel>>> expected;
    const OctreeLevel &fine = octree[level - 1], &coarse = octree[level];
    for (std::size_t i = 0; i < fine.keys.size(); ++i) {
      RC_ASSERT((i == 0 || fine.keys[i - 1] < fine.keys[i]));
      expected[fine.keys[i] >> 3].emplace_back(static_cast<unsigned>(fine.keys[i] & 7),
                                               code.load(&fine.records[i * code.bytes()]));
    }
    RC_ASSERT(expected.size() == coarse.keys.size());
    std::size_t i = 0;
    for (const auto& [key, children] : expected) {
      RC_ASSERT(coarse.keys[i] == key);
      Voxel mean;
      for (std::size_t d = 0; d < kVoxelDirections; ++d) {
        for (unsigned column = 0; column < 4; ++column) {
          float open = 1;
          for (const auto& [number, child] : children) {
            const unsigned x = number & 1, y = number >> 1 & 1, z = number >> 2;
            const unsigned across = d < 2 ? y + 2 * z : d < 4 ? x + 2 * z : x + 2 * y;
            if (across == column) open *= 1 - child.cover[d];
          }
          mean.cover[d] += (1 - open) / 4;
        }
        unsigned lit = 0;
        for (const auto& [number, child] : children) {
          mean.color[d] += child.color[d];
          lit += child.color[d] == Vec3{} ? 0 : 1;
        }
        if (lit != 0) mean.color[d] = mean.color[d] / static_cast<float>(lit);
      }
      std::vector<std::byte> record(code.bytes());
      code.store(record.data(), mean);
      RC_ASSERT(std::memcmp(record.data(), &coarse.records[i * code.bytes()], record.size()) == 0);
      ++i;
    }
  }
}

/// A wall across x covers all of it, and half of what is seen along it.
TEST(Octree, CoverIsOfColumns) {
  const VoxelCode code(VoxelForm::halves);
  std::vector<VoxelKey> leaves;
  for (unsigned i = 0; i < 4; ++i) leaves.push_back(morton_key({0, i % 2, i / 2}));
  std::ranges::sort(leaves);
  Octree octree = grow(leaves, 2);
  Voxel solid;
  solid.cover.fill(1);
  solid.color.fill({1, 2, 3});
  octree[0].records.resize(4 * code.bytes());
  for (std::size_t i = 0; i < 4; ++i) code.store(&octree[0].records[i * code.bytes()], solid);
  pull(octree, code);
  const Voxel parent = code.load(octree[1].records.data());
  EXPECT_EQ(parent.cover, (std::array<float, 6>{1, 1, 0.5F, 0.5F, 0.5F, 0.5F}));
  EXPECT_EQ(parent.color, solid.color);
}

RC_GTEST_PROP(VoxelCode, LoadsAnyBits, (const std::vector<std::uint8_t>& bytes)) {
  for (const VoxelForm form : test::kForms) {
    const VoxelCode code(form);
    std::vector<std::byte> record(code.bytes());
    for (std::size_t i = 0; i < bytes.size(); ++i) record[i % record.size()] ^= std::byte{bytes[i]};
    const Voxel voxel = code.load(record.data());
    for (std::size_t d = 0; d < kVoxelDirections; ++d) {
      const Vec3 c = voxel.color[d];
      for (const float x : {c.x, c.y, c.z, voxel.cover[d]}) RC_ASSERT(x >= 0 && x <= 65504);
    }
    std::vector<std::byte> again(code.bytes()), twice(code.bytes());
    code.store(again.data(), voxel);
    code.store(twice.data(), code.load(again.data()));
    RC_ASSERT(again == twice);
  }
}

}  // namespace
}  // namespace gicodec::voxels
