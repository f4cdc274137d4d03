// Looking light up.
#include "octrees.h"

#include <gtest/gtest.h>

namespace gicodec::voxels {
namespace {

constexpr BrickShape kShape{4};
constexpr auto kFieldForm = VoxelForm::halves;
constexpr std::uint32_t kCells = 24;

VoxelField field_of(const BrickPool& pool, const std::function<bool(std::size_t)>& has = {}) {
  VoxelField field(pool.shape(), kFieldForm);
  field.assign(test::geometry(pool.slots()), pool.bricks(), pool.light(), has);
  return field;
}

Vec3 seen(const Voxel& voxel, Vec3 n) {
  return voxel.color[n.x >= 0 ? 0 : 1] * (n.x * n.x) + voxel.color[n.y >= 0 ? 2 : 3] * (n.y * n.y) +
         voxel.color[n.z >= 0 ? 4 : 5] * (n.z * n.z);
}

TEST(VoxelField, IsExactAtTheCentresOfVoxels) {
  for (const unsigned side : {4U, 8U}) {
    const Octree octree = test::random_octree(kCells, 0.1F, 1, side, kFieldForm);
    const VoxelField field = field_of(test::pooled(octree, {side}, kFieldForm));
    const VoxelCode code(kFieldForm);
    ddgi::Random random(2);
    for (unsigned level = 0; level < octree.size(); ++level) {
      for (std::size_t i = 0; i < octree[level].keys.size(); i += 7) {
        const Voxel voxel = code.load(&octree[level].records[i * code.bytes()]);
        const Vec3 at = test::centre_of(morton_cell(octree[level].keys[i]), level);
        const float width = std::ldexp(0.5F, static_cast<int>(level));
        for (std::size_t d = 0; d < kVoxelDirections; ++d) {
          EXPECT_EQ(field.irradiance(at, axis_of(d), width), voxel.color[d]);
        }
        const Vec3 n = test::random_direction(random);
        test::expect_near(field.irradiance(at, n, width), seen(voxel, n), 1e-5F);
      }
    }
  }
}

TEST(VoxelField, IsConstantWhereVoxelsAre) {
  Octree octree = test::random_octree(kCells, 0.05F, 4, 4, kFieldForm);
  const VoxelCode code(kFieldForm);
  Voxel constant;
  constant.color.fill({0.25F, 3, 100});
  for (std::size_t i = 0; i < octree[0].keys.size(); ++i) {
    code.store(&octree[0].records[i * code.bytes()], constant);
  }
  pull(octree, code);
  const VoxelField field = field_of(test::pooled(octree, kShape, kFieldForm));
  ddgi::Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 value = field.irradiance(test::random_point(random, -20, 30),
                                        test::random_direction(random), random.in(0, 20));
    test::expect_near(value / 100, Vec3{0.25F, 3, 100} / 100, 1e-5F);
  }
}

TEST(VoxelField, GoesFromVoxelToVoxelAndFromLevelToLevel) {
  const Octree octree = test::random_octree(8, 1, 6, 4, kFieldForm);  // all are there
  const VoxelField field = field_of(test::pooled(octree, kShape, kFieldForm));
  const Vec3 a = test::centre_of({2, 3, 4}, 0), b = test::centre_of({3, 3, 4}, 0), up{0, 1, 0};
  const Vec3 at_a = field.irradiance(a, up, 0), at_b = field.irradiance(b, up, 0);
  test::expect_near(field.irradiance(lerp(a, b, 0.25F), up, 0), lerp(at_a, at_b, 0.25F), 1e-5F);
  const Vec3 coarse = field.irradiance(a, up, 1);
  EXPECT_NE(coarse, at_a);
  test::expect_near(field.irradiance(a, up, 0.5F * std::sqrt(2.0F)), lerp(at_a, coarse, 0.5F),
                    1e-5F);
  EXPECT_EQ(field.irradiance(a, up, 1e9F), field.irradiance(a, up, 1));
}

/// What is within a solid has no share of what is outside.
TEST(VoxelField, DarkDirectionsHaveNoWeight) {
  Octree octree = test::random_octree(4, 1, 7, 4, kFieldForm);
  const VoxelCode code(kFieldForm);
  for (std::size_t i = 0; i < octree[0].keys.size(); ++i) {
    Voxel voxel = code.load(&octree[0].records[i * code.bytes()]);
    if (morton_cell(octree[0].keys[i])[0] == 1) voxel.color[0] = {};
    code.store(&octree[0].records[i * code.bytes()], voxel);
  }
  const VoxelField field = field_of(test::pooled(octree, kShape, kFieldForm));
  const Vec3 lit = test::centre_of({0, 2, 1}, 0), dark = test::centre_of({1, 2, 1}, 0);
  const Vec3 between = lerp(lit, dark, 0.7F), east{1, 0, 0};
  test::expect_near(field.irradiance(between, east, 0), field.irradiance(lit, east, 0), 1e-5F);
  EXPECT_EQ(field.irradiance(dark, east, 0), Vec3{});
  EXPECT_NE(field.irradiance(dark, {-1, 0, 0}, 0), Vec3{});
}

/// As soon as the coarsest level is there, all is lit; then by what is there of finer ones.
TEST(VoxelField, CoarserLevelsStandInForWhatHasNotCome) {
  const Octree octree = test::random_octree(kCells, 0.1F, 8, 4, kFieldForm);
  const BrickPool pool = test::pooled(octree, kShape, kFieldForm);
  ddgi::Random random(9);
  for (unsigned least = static_cast<unsigned>(octree.size()); least-- > 0;) {
    const VoxelField field = field_of(pool, [&](std::size_t slot) {
      const auto place = test::place_in(pool, static_cast<std::uint32_t>(slot));
      return place && place->level >= least;
    });
    for (int i = 0; i < 200; ++i) {
      const Vec3 light =
          field.irradiance(test::random_point(random, -5, 20), test::random_direction(random), 0);
      EXPECT_GE(std::min({light.x, light.y, light.z}), 0.09F);
    }
    const VoxelKey key = octree[least].keys[octree[least].keys.size() / 2];
    const Vec3 at = test::centre_of(morton_cell(key), least);
    EXPECT_EQ(field.irradiance(at, {0, 0, 1}, 0),
              field_of(pool).irradiance(at, {0, 0, 1}, std::ldexp(0.5F, static_cast<int>(least))));
  }
}

/// In places that are in range and often the same, or anywhere.
void check_any_bytes(std::uint32_t seed, bool places) {
  ddgi::Random random(seed);
  const BrickShape shape{seed % 2 == 0 ? 4U : 8U};
  const std::uint32_t slots = 1 + seed % 40;
  for (const VoxelForm form : test::kForms) {
    BrickPool pool(slots, shape, form);
    std::vector<std::byte> bricks(pool.bricks().size()), light(pool.light().size());
    for (std::byte& b : bricks) b = std::byte(random.next() * 256);
    for (std::byte& b : light) b = std::byte(random.next() * 256);
    for (std::uint32_t slot = 0; places && slot < slots; ++slot) {
      const auto any = [&](float n) { return static_cast<std::uint32_t>(random.next() * n); };
      pack_brick_place({static_cast<std::uint8_t>(any(3)), {any(3), any(3), any(3)}},
                       std::span<std::byte, kBrickPlaceBytes>(&bricks[slot * shape.place_bytes()],
                                                              kBrickPlaceBytes));
    }
    constexpr float kInf = std::numeric_limits<float>::infinity();
    const float none = std::numeric_limits<float>::quiet_NaN();
    VolumeGeometry geometry = test::geometry(slots);
    VoxelField field(shape, form);
    for (const float spacing : {0.5F, 0.0F, -1.0F, 1e-30F, 1e30F, kInf, none}) {
      geometry.spacing = {spacing, spacing, spacing};
      field.assign(geometry, bricks, light);
      for (const float far : {10.0F, 1e20F, kInf, none}) {
        for (const float width : {0.0F, 3.0F, 1e30F, kInf, none}) {
          const Vec3 l = field.irradiance(test::random_point(random, -1, 1) * far,
                                          test::random_direction(random), width);
          EXPECT_TRUE(std::isfinite(l.x) && std::isfinite(l.y) && std::isfinite(l.z));
          EXPECT_GE(std::min({l.x, l.y, l.z}), 0);
        }
      }
    }
  }
}

TEST(VoxelField, TakesAnyBytes) {
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    check_any_bytes(seed, false);
    check_any_bytes(seed, true);
  }
}

}  // namespace
}  // namespace gicodec::voxels
