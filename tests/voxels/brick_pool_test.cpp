// Bricks keep their slots.
#include "octrees.h"

#include <gtest/gtest.h>

namespace gicodec::voxels {
namespace {

std::map<test::Place, std::uint32_t> slots_of(const BrickPool& pool) {
  std::map<test::Place, std::uint32_t> slots;
  for (std::uint32_t slot = 0; slot < pool.slots(); ++slot) {
    const auto place = test::place_in(pool, slot);
    if (place) slots[test::key_of(*place)] = slot;
  }
  return slots;
}

/// How many voxels the textures hold, or nothing where one is not the octree's, or a record of
/// none is not zero.
std::optional<std::size_t> voxels_in(const BrickPool& pool, const Octree& octree, VoxelForm form) {
  const VoxelCode code(form);
  const BrickShape& shape = pool.shape();
  const std::vector<std::byte> zero(code.bytes());
  std::size_t found = 0;
  for (std::uint32_t slot = 0; slot < pool.slots(); ++slot) {
    const auto place = test::place_in(pool, slot);
    const std::byte* const mask = &pool.bricks()[slot * shape.place_bytes() + kBrickPlaceBytes];
    for (unsigned bit = 0; bit < shape.voxels(); ++bit) {
      const std::byte* const record =
          &pool.light()[(std::size_t{slot} * shape.voxels() + bit) * code.bytes()];
      const std::byte* expected = zero.data();
      if ((mask[bit / 8] >> (bit % 8) & std::byte{1}) != std::byte{0}) {
        if (!place) return {};
        const OctreeLevel& level = octree.at(place->level);
        const unsigned n = shape.side;
        const VoxelKey key = morton_key({place->at[0] * n + bit % n, place->at[1] * n + bit / n % n,
                                         place->at[2] * n + bit / n / n});
        const auto at = std::ranges::lower_bound(level.keys, key);
        if (at == level.keys.end() || *at != key) return {};
        expected = &level.records[static_cast<std::size_t>(at - level.keys.begin()) * code.bytes()];
        ++found;
      }
      if (std::memcmp(record, expected, code.bytes()) != 0) return {};
    }
  }
  return found;
}

std::size_t voxels_of(const Octree& octree) {
  std::size_t voxels = 0;
  for (const OctreeLevel& level : octree) voxels += level.keys.size();
  return voxels;
}

TEST(BrickPool, BricksKeepTheirSlotsAndFreeOnesAreZero) {
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const BrickShape shape{seed % 2 == 0 ? 4U : 8U};
    const VoxelForm form = test::kForms[seed / 2 % 2];
    BrickPool pool(200, shape, form);
    std::map<test::Place, std::uint32_t> before;
    for (std::uint32_t frame = 0; frame < 4; ++frame) {
      const Octree octree = test::random_octree(16, 0.01F, 100 * seed + frame, shape.side, form);
      ASSERT_EQ(pool.put(octree), 0U);
      EXPECT_EQ(voxels_in(pool, octree, form), voxels_of(octree));
      const auto now = slots_of(pool);
      EXPECT_EQ(now.size(), test::bricks_in(octree, shape));
      for (const auto& [place, slot] : before) {
        const auto kept = now.find(place);
        EXPECT_TRUE(kept == now.end() || kept->second == slot);
      }
      before = now;
    }
  }
}

TEST(BrickPool, TheFinestBricksAreLeftOutOfAFullPool) {
  const BrickShape shape{4};
  const auto form = VoxelForm::shared_exponent;
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const Octree octree = test::random_octree(16, 0.02F, seed, 4, form);
    const std::uint32_t bricks = test::bricks_in(octree, shape);
    BrickPool pool(1 + seed * (bricks - 2) / 7, shape, form);
    // Full of others before: these give way.
    EXPECT_GT(pool.put(test::random_octree(16, 0.5F, seed + 1, 4, form)), 0U);
    EXPECT_EQ(pool.put(octree), bricks - pool.slots());
    const auto held = voxels_in(pool, octree, form);
    ASSERT_TRUE(held);
    EXPECT_LT(*held, voxels_of(octree));
    const auto slots = slots_of(pool);
    EXPECT_EQ(slots.size(), pool.slots());
    EXPECT_TRUE(test::is_closed(pool, BlockMask(pool.slots(), 1),
                                static_cast<unsigned>(octree.size()) - 1));
    EXPECT_EQ(pool.put(octree), bricks - pool.slots());
    EXPECT_EQ(slots_of(pool), slots);
  }
}

/// Depth first, so that parents are near by in runs of slots.
TEST(BrickPool, BricksStandNextToThoseInThem) {
  const BrickShape shape{4};
  const Octree octree = test::random_octree(32, 0.1F, 3, 4, VoxelForm::halves);
  const BrickPool pool = test::pooled(octree, shape, VoxelForm::halves);
  std::pair<std::uint64_t, int> last{0, -100};
  for (std::uint32_t slot = 0; slot < test::bricks_in(octree, shape); ++slot) {
    const auto place = test::place_in(pool, slot);
    ASSERT_TRUE(place);
    const std::pair<std::uint64_t, int> now{morton_key(place->at) << 3 * place->level,
                                            -int{place->level}};
    EXPECT_LT(last, now);
    last = now;
  }
  EXPECT_FALSE(test::place_in(pool, test::bricks_in(octree, shape)));
}

}  // namespace
}  // namespace gicodec::voxels
