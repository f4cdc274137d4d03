// Points on surfaces: how many, where, how far from each other.
#include "ao/point_generation.h"
#include "ddgi/noise.h"
#include "ddgi/rooms.h"
#include "ddgi/shapes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstring>

namespace gicodec::ao {
namespace {

using ddgi::Vec3;

/// Distance of each of the points to the nearest other one on its side; slow.
std::vector<float> nearest(std::span<const SurfacePoint> points) {
  std::vector<float> out(points.size(), 1e9F);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (i == j || !(dot(points[i].normal, points[j].normal) > 0)) continue;
      out[i] = std::min(out[i], length(points[i].position - points[j].position));
    }
  }
  return out;
}

std::vector<SurfacePoint> square(std::size_t count, std::uint32_t seed) {
  ddgi::Random random(seed);
  std::vector<SurfacePoint> points(count);
  for (SurfacePoint& point : points) {
    const float x = random.next(), z = random.next();
    point = {{x, 0, z}, {0, 1, 0}, {0, 1, 0}};
  }
  return points;
}

std::vector<SurfacePoint> chosen(std::span<const SurfacePoint> points,
                                 std::span<const std::uint32_t> indices) {
  std::vector<SurfacePoint> out;
  for (const std::uint32_t i : indices) out.push_back(points[i]);
  return out;
}

RC_GTEST_PROP(Elimination, KeepsExactlyAsManyAsAskedFor, ()) {
  const auto count = *rc::gen::inRange<std::size_t>(1, 300);
  const auto keep = *rc::gen::inRange<std::size_t>(0, count + 1);
  const auto points = square(count, *rc::gen::arbitrary<std::uint32_t>());
  ddgi::ThreadPool pool(1);
  const auto kept = eliminate(points, keep, 0.05F, pool);
  RC_ASSERT(kept.size() == keep);
  RC_ASSERT(std::ranges::is_sorted(kept));
  RC_ASSERT(std::ranges::adjacent_find(kept) == kept.end());
  if (!kept.empty()) RC_ASSERT(kept.back() < count);
}

RC_GTEST_PROP(Elimination, OfHalfLeavesADistance, ()) {
  const std::size_t keep = *rc::gen::inRange<std::size_t>(100, 500);
  const auto points = square(2 * keep, *rc::gen::arbitrary<std::uint32_t>());
  ddgi::ThreadPool pool(1);
  const float r_max = largest_radius(1, static_cast<double>(keep));
  const auto kept = chosen(points, eliminate(points, keep, r_max, pool));
  // The paper's weights remove half of what is nearer than about the half of the largest distance;
  // random points have some that nearly touch.
  const auto distances = nearest(kept);
  RC_ASSERT(*std::ranges::min_element(distances) > 0.6F * r_max);
}

/// The definition, in quadratic time.
std::vector<std::uint32_t> eliminate_slowly(std::span<const SurfacePoint> samples, std::size_t keep,
                                            float r_max) {
  const float reach = 2 * r_max;
  std::vector<bool> gone(samples.size());
  for (std::size_t left = samples.size(); left > keep; --left) {
    std::size_t heaviest = samples.size();
    double most = -1;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (gone[i]) continue;
      double sum = 0;
      for (std::size_t j = 0; j < samples.size(); ++j) {
        const float d = length(samples[i].position - samples[j].position);
        if (i == j || gone[j] || d >= reach) continue;
        sum += std::pow(1 - d / reach, 8);
      }
      if (sum > most) most = sum, heaviest = i;
    }
    gone[heaviest] = true;
  }
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    if (!gone[i]) kept.push_back(i);
  }
  return kept;
}

RC_GTEST_PROP(Elimination, TakesTheHeaviestFirst, ()) {
  const auto count = *rc::gen::inRange<std::size_t>(20, 60);
  const auto points = square(count, *rc::gen::arbitrary<std::uint32_t>());
  ddgi::ThreadPool pool(1);
  // All of them have neighbours, so that no two weigh the same.
  RC_ASSERT(eliminate(points, count / 2, 0.8F, pool) == eliminate_slowly(points, count / 2, 0.8F));
}

bool same(const GeneratedPoints& a, const GeneratedPoints& b) {
  if (a.instances.size() != b.instances.size() || a.points != b.points) return false;
  for (std::size_t i = 0; i < a.instances.size(); ++i) {
    const auto &p = a.instances[i].points, &q = b.instances[i].points;
    if (p.size() != q.size() || !(a.instances[i].grid == b.instances[i].grid) ||
        std::memcmp(p.data(), q.data(), p.size() * sizeof p[0]) != 0) {
      return false;
    }
  }
  return true;
}

TEST(Generation, IsTheSameForAnyNumberOfThreads) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  GenerationOptions options;
  options.points = 40;
  ddgi::ThreadPool one(1), two(2), five(5);
  const auto points = generate_points(scene, options, one);
  EXPECT_TRUE(same(points, generate_points(scene, options, two)));
  EXPECT_TRUE(same(points, generate_points(scene, options, five)));
  options.seed = 2;
  EXPECT_FALSE(same(points, generate_points(scene, options, one)));
}

/// A floor of 4 × 6 m, scaled by 2 in the world, and perhaps seen from both sides.
ddgi::Scene floor(bool two_sided, bool dynamic) {
  ddgi::Scene scene;
  scene.name = "floor";
  ddgi::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 3}, {2, 0, 3}, {2, 0, 0}};
  mesh.normals.assign(4, {0, 1, 0});
  mesh.uvs.resize(4);
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = scene.add_material({.name = "floor", .two_sided = two_sided});
  scene.add_object({.name = "floor",
                    .meshes = {scene.add_mesh(std::move(mesh))},
                    .transform = ddgi::scaling({2, 2, 2}),
                    .dynamic = dynamic});
  scene.grid = {2, 2, 2};
  return scene;
}

TEST(Generation, IsByTheAreaInTheWorld) {
  ddgi::ThreadPool pool(2);
  GenerationOptions options;
  options.points = 50;
  const auto one = generate_points(floor(false, false), options, pool);
  ASSERT_EQ(one.instances.size(), 1U);
  const PointInstance& instance = one.instances.front();
  EXPECT_EQ(instance.points.size(), 24U * 50 / 2);
  // Half of the area's hexagons have a point; radii are of the mesh's space.
  EXPECT_NEAR(instance.grid.radius, 2 * largest_radius(24, 24 * 25) / 2, 1e-5F);
  EXPECT_EQ(generate_points(floor(true, false), options, pool).instances[0].points.size(),
            24U * 50);
  for (const SurfacePoint& point : instance.points) {
    EXPECT_EQ(point.position.y, 0);
    EXPECT_TRUE(point.position.x >= 0 && point.position.x <= 2.0001F);
    EXPECT_TRUE(point.position.z >= 0 && point.position.z <= 3.0001F);
    EXPECT_EQ(point.normal, (Vec3{0, 1, 0}));
  }
}

TEST(Generation, OfBothSidesHasAsManyOfEach) {
  ddgi::ThreadPool pool(2);
  GenerationOptions options;
  options.points = 50;
  const auto both = generate_points(floor(true, false), options, pool);
  const auto down = std::ranges::count_if(both.instances[0].points,
                                          [](const SurfacePoint& p) { return p.normal.y < 0; });
  EXPECT_NEAR(static_cast<double>(down), 600, 30);
  for (const float d : nearest(both.instances[0].points)) EXPECT_GT(d, 0.03F);
}

TEST(Generation, KeepsToTheScenesVolumeButForWhatMoves) {
  ddgi::ThreadPool pool(2);
  GenerationOptions options;
  options.points = 100;
  const auto with_volume = [](bool dynamic) {
    ddgi::Scene scene = floor(false, dynamic);
    scene.volume = {{2, 0, 2}, {9, 1, 3}};  // And a metre more: 3 × 3 m of the floor.
    return scene;
  };
  const auto inside = generate_points(with_volume(false), options, pool);
  EXPECT_EQ(inside.instances[0].points.size(), 9U * 50);
  for (const SurfacePoint& point : inside.instances[0].points) {
    EXPECT_TRUE(point.position.x >= 0.4999F && point.position.z >= 0.4999F);
    EXPECT_LE(point.position.z, 2.0001F);
  }
  EXPECT_EQ(generate_points(with_volume(true), options, pool).instances[0].points.size(), 24U * 50);
  options.outside = true;
  EXPECT_EQ(generate_points(with_volume(false), options, pool).instances[0].points.size(),
            24U * 50);
}

TEST(Generation, ThatIsTooMuchSaysSo) {
  ddgi::ThreadPool pool(2);
  GenerationOptions options;
  options.points = 1000;
  options.max_points = 240;
  const auto few = generate_points(floor(false, false), options, pool);
  EXPECT_EQ(few.instances[0].points.size(), 240U);
  EXPECT_NEAR(few.points, 20, 1e-6);
  ASSERT_EQ(few.remarks.size(), 1U);
  EXPECT_NE(few.remarks[0].find("max-points"), std::string::npos);
}

TEST(Generation, EveryPointHasAPlaceInItsGrid) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  GenerationOptions options;
  options.points = 60;
  ddgi::ThreadPool pool(2);
  for (const PointInstance& instance : generate_points(scene, options, pool).instances) {
    const AoGrid& grid = instance.grid;
    for (const SurfacePoint& point : instance.points) {
      const std::array<float, 3> at{point.position.x, point.position.y, point.position.z};
      const std::array<std::uint32_t, 3> sides{grid.cells.x, grid.cells.y, grid.cells.z};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float cell = (at[axis] - grid.origin[axis]) / grid.cell;
        ASSERT_TRUE(cell >= 0 && cell < static_cast<float>(sides[axis]));
      }
    }
  }
}

}  // namespace
}  // namespace gicodec::ao
