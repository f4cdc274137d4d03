// Cuts through the octree for a view.
#include "voxels/cut.h"

#include "octrees.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numeric>

namespace gicodec::voxels {
namespace {

constexpr auto kForm = VoxelForm::shared_exponent;

/// What a viewer sees has with the bricks of the cut the light that it has with all.
RC_GTEST_PROP(Cut, IsClosedAndAllThatIsLookedUp, (std::uint32_t seed, bool large)) {
  ddgi::Random random(seed);
  const BrickShape shape{large ? 8U : 4U};
  const Octree octree = test::random_octree(40, 0.01F, seed, shape.side, kForm);
  const BrickPool pool = test::pooled(octree, shape, kForm);
  const VolumeGeometry geometry = test::geometry(pool.slots());
  const CutView view{test::random_point(random, 0, 10), 0.01F, random.in(0, 100)};
  std::vector<Vec3> points;
  for (int i = 0; i < 20; ++i) points.push_back(test::random_point(random, -3, 22));
  const BlockMask mask = cut(pool.bricks(), shape, geometry, view, points);
  RC_ASSERT(mask.size() == pool.slots());
  RC_ASSERT(test::is_closed(pool, mask, static_cast<unsigned>(octree.size()) - 1));
  VoxelField all(shape, kForm), some(shape, kForm);
  all.assign(geometry, pool.bricks(), pool.light());
  some.assign(geometry, pool.bricks(), pool.light(), [&](std::size_t s) { return mask[s] != 0; });
  for (const Vec3 point : points) {
    const float width = length(point - view.eye) * view.pixel * view.detail;
    const Vec3 normal = test::random_direction(random);
    RC_ASSERT(some.irradiance(point, normal, width) == all.irradiance(point, normal, width));
  }
}

TEST(Cut, FromNearGoesDownToTheLeaves) {
  const BrickShape shape{4};
  const Octree octree = test::random_octree(40, 0.02F, 1, 4, kForm);
  const BrickPool pool = test::pooled(octree, shape, kForm);
  const VolumeGeometry geometry = test::geometry(pool.slots());
  const auto bricks_at = [&](float distance) {
    std::vector<std::size_t> levels(octree.size());
    const Vec3 at = test::centre_of(morton_cell(octree[0].keys[100]), 0);
    const BlockMask mask =
        cut(pool.bricks(), shape, geometry, {at + Vec3{distance, 0, 0}, 0.01F, 4}, {{at}});
    for (std::uint32_t slot = 0; slot < pool.slots(); ++slot) {
      if (mask[slot] != 0) ++levels.at(test::place_in(pool, slot)->level);
    }
    return levels;
  };
  const auto near = bricks_at(0);
  for (const std::size_t bricks : near) EXPECT_GE(bricks, 1U);
  EXPECT_LE(near[0], 8U);
  const auto far = bricks_at(30);  // voxels of 1.2 m: between 1 m and 2 m
  EXPECT_EQ(far[0], 0U);
  for (std::size_t level = 1; level < far.size(); ++level) EXPECT_GE(far[level], 1U);
  const auto farthest = bricks_at(1e6F);
  // The whole scene coarsely.
  const std::size_t sum = std::accumulate(farthest.begin(), farthest.end(), std::size_t{0});
  EXPECT_LE(16 * sum, static_cast<std::size_t>(test::bricks_in(octree, shape)));
  EXPECT_EQ(farthest.back(), 1U);
  for (std::size_t level = 0; level < farthest.size(); ++level) {
    const bool all = farthest[level] == brick_counts(octree, shape)[level];
    EXPECT_TRUE(all || farthest[level] == 0) << level;
  }
}

TEST(Cut, OfAllPointsAtNoDistanceIsAll) {
  const BrickShape shape{4};
  const Octree octree = test::random_octree(20, 0.05F, 2, 4, kForm);
  const BrickPool pool = test::pooled(octree, shape, kForm);
  std::vector<Vec3> points;
  for (const VoxelKey key : octree[0].keys) points.push_back(test::centre_of(morton_cell(key), 0));
  const BlockMask mask =
      cut(pool.bricks(), shape, test::geometry(pool.slots()), {{}, 0.01F, 0}, points);
  EXPECT_EQ(std::ranges::count(mask, 1), test::bricks_in(octree, shape));
}

/// A client that is sent cuts and what changed holds no brick where it is not any more, whatever it
/// looks at and whatever slots are used again.
RC_GTEST_PROP(Cut, NobodyHoldsWhatIsGone, (std::uint32_t seed)) {
  ddgi::Random random(seed);
  const BrickShape shape{4};
  BrickPool pool(100, shape, kForm);
  ChangedSlots changed;
  std::vector<std::byte> held(pool.bricks().size());
  const std::size_t size = shape.place_bytes();
  for (std::uint32_t frame = 0; frame < 8; ++frame) {
    static_cast<void>(pool.put(test::random_octree(16, 0.003F, 10 * seed + frame, 4, kForm)));
    changed.add(pool.bricks(), shape);
    const std::array points{test::random_point(random, -2, 6)};
    BlockMask mask =
        cut(pool.bricks(), shape, test::geometry(pool.slots()), {points[0], 0.01F, 4}, points);
    for (std::uint32_t slot = 0; slot < pool.slots(); ++slot) {
      const auto now = pool.bricks().subspan(slot * size, size);
      if ((mask[slot] | changed.slots()[slot]) != 0) std::ranges::copy(now, &held[slot * size]);
      const auto has = brick_in(std::span(held).subspan(slot * size, size));
      RC_ASSERT(!has || has == test::place_in(pool, slot));
      RC_ASSERT(frame > 0 || changed.slots()[slot] == 0);
    }
  }
}

RC_GTEST_PROP(Cut, TakesAnyBytes, (const std::vector<std::uint8_t>& bytes, std::uint32_t seed)) {
  ddgi::Random random(seed);
  std::vector<std::byte> bricks(bytes.size());
  std::memcpy(bricks.data(), bytes.data(), bytes.size());
  VolumeGeometry geometry = test::geometry(1);
  const float none = std::numeric_limits<float>::quiet_NaN();
  for (const float spacing : {0.5F, 0.0F, -1.0F, none}) {
    geometry.spacing[0] = spacing;
    const std::vector<Vec3> points{test::random_point(random, -9, 9), {none, 0, 0}, {1e30F, 0, 0}};
    const BlockMask mask = cut(bricks, {4}, geometry, {{}, 0.01F, random.in(0, 9)}, points);
    RC_ASSERT(mask.size() == bricks.size() / 16);
  }
}

}  // namespace
}  // namespace gicodec::voxels
