// Which voxels triangles touch.
#include "dump/error.h"
#include "octrees.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace gicodec::voxels {
namespace {

using Point = std::array<double, 3>;

/// What is left of a triangle within a box, cut plane by plane.
bool clipped(const Triangle& triangle, const Point& centre, double half) {
  std::vector<Point> polygon;
  for (const Vec3 v : triangle) polygon.push_back({v.x, v.y, v.z});
  for (unsigned plane = 0; plane < 6 && !polygon.empty(); ++plane) {
    const unsigned axis = plane / 2;
    const double sign = plane % 2 == 0 ? 1 : -1;
    const auto out = [&](const Point& p) { return sign * (p[axis] - centre[axis]) - half; };
    std::vector<Point> rest;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double da = out(a), db = out(b);
      if (da <= 0) rest.push_back(a);
      if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
        const double t = da / (da - db);
        Point at;
        for (std::size_t k = 0; k < 3; ++k) at[k] = a[k] + (b[k] - a[k]) * t;
        rest.push_back(at);
      }
    }
    polygon = rest;
  }
  return !polygon.empty();
}

bool holds(const Point& centre, double half, const Point& p) {
  return std::abs(p[0] - centre[0]) <= half && std::abs(p[1] - centre[1]) <= half &&
         std::abs(p[2] - centre[2]) <= half;
}

RC_GTEST_PROP(Voxelise, TrianglesOverlapTheBoxesThatTheyReach, (std::uint32_t seed)) {
  ddgi::Random random(seed);
  constexpr double kNear = 1e-6;
  const Point centre{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)};
  const double half = random.in(0.05F, 1);
  for (int i = 0; i < 20; ++i) {
    const float far = random.in(0.1F, 3);
    Triangle t{test::random_point(random, -far, far), test::random_point(random, -far, far),
               test::random_point(random, -far, far)};
    if (i % 4 == 1) t[1].x = t[0].x = t[2].x;  // along a plane
    if (i % 4 == 2) t[2] = t[1];               // or nothing but an edge
    const bool overlap = overlaps(t, centre, half);
    RC_ASSERT(overlap || !clipped(t, centre, half * (1 - kNear)));
    RC_ASSERT(!overlap || clipped(t, centre, half * (1 + kNear)));
    for (int sample = 0; sample < 50; ++sample) {
      const float u = random.next(), v = random.in(0, 1 - u);
      const Vec3 p = t[0] * (1 - u - v) + t[1] * u + t[2] * v;
      RC_ASSERT(overlap || !holds(centre, half * (1 - kNear), {p.x, p.y, p.z}));
    }
  }
}

/// That a surface of that normal is looked up in (docs/voxels.md, "Gathering").
Directions faced_by(Vec3 n) {
  constexpr float kMin = 0.1F;
  const std::array faced{n.x > kMin, n.x<-kMin, n.y> kMin, n.y<-kMin, n.z> kMin, n.z < -kMin};
  Directions bits = 0;
  for (std::size_t d = 0; d < faced.size(); ++d) bits |= static_cast<Directions>(faced[d] << d);
  return bits;
}

/// As by looking at each triangle and each cell.
TEST(Voxelise, FindsTheCellsThatTrianglesTouch) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  ddgi::ThreadPool pool(2);
  const VoxelGrid grid(scene.volume, 0.9F);  // which cuts the room's walls off
  const Voxeliser voxeliser(scene, grid, pool);
  const ddgi::FrameState state = scene.state_at(1.3);
  std::map<VoxelKey, Directions> touched;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    for (const std::uint32_t number : scene.objects[i].meshes) {
      const ddgi::Mesh& mesh = scene.meshes[number];
      for (const auto& corners : mesh.triangles) {
        Triangle t;
        Directions faced = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          t[k] = (state.transforms[i].point(mesh.positions[corners[k]]) - grid.origin) / grid.size;
          faced |= faced_by(normalize(state.transforms[i].normal(mesh.normals[corners[k]])));
        }
        Cell c{};
        for (c[2] = 0; c[2] < grid.cells[2]; ++c[2]) {
          for (c[1] = 0; c[1] < grid.cells[1]; ++c[1]) {
            for (c[0] = 0; c[0] < grid.cells[0]; ++c[0]) {
              if (overlaps(t, {c[0] + 0.5, c[1] + 0.5, c[2] + 0.5}, 0.5)) {
                touched[morton_key(c)] |= faced;
              }
            }
          }
        }
      }
    }
  }
  std::vector<SurfaceVoxel> expected;
  for (const auto& [key, faced] : touched) expected.push_back({key, faced});
  EXPECT_EQ(voxeliser.voxels(state), expected);
  EXPECT_NE(voxeliser.voxels(scene.state_at(3)), expected);
}

/// A leaf that is seen from both sides is looked up from both.
TEST(Voxelise, SheetsFaceBothSides) {
  for (const bool two_sided : {false, true}) {
    ddgi::Scene scene;
    ddgi::MeshBuilder sheet(scene.add_material({.name = "leaf", .two_sided = two_sided}));
    sheet.patch({0, 0, 0}, {0, 0, 1}, {1, 0, 0});
    scene.add_object({.name = "sheet", .meshes = {scene.add_mesh(sheet.take())}});
    ddgi::ThreadPool pool(1);
    const VoxelGrid grid({{0, 0, 0}, {1, 1, 1}}, 2);
    const auto voxels = Voxeliser(scene, grid, pool).voxels(scene.state_at(0));
    ASSERT_EQ(voxels.size(), 1U);
    EXPECT_EQ(voxels[0].faced, two_sided ? 0b1100U : 0b100U);
  }
}

TEST(Voxelise, IsTheSameForAnyNumberOfThreads) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  const VoxelGrid grid({scene.bounds().lo, scene.bounds().hi}, 0.3F);
  ddgi::ThreadPool one(1), four(4);
  EXPECT_EQ(Voxeliser(scene, grid, one).voxels(scene.state_at(1)),
            Voxeliser(scene, grid, four).voxels(scene.state_at(1)));
}

RC_GTEST_PROP(Voxelise, KeysAreCells, (std::uint32_t seed)) {
  ddgi::Random random(seed);
  const auto any = [&] { return static_cast<std::uint32_t>(random.next() * (1U << 21)); };
  const Cell cell{any(), any(), any()};
  const VoxelKey key = morton_key(cell);
  RC_ASSERT(morton_cell(key) == cell);
  RC_ASSERT(morton_cell(key >> 3) == (Cell{cell[0] / 2, cell[1] / 2, cell[2] / 2}));
  RC_ASSERT((key >> 9) == morton_key({cell[0] / 8, cell[1] / 8, cell[2] / 8}));
}

TEST(Voxelise, AGridCoversItsBox) {
  const ddgi::Box box{{-3, 0, 7}, {5, 1.1F, 7.9F}};
  for (const float size : {0.01F, 0.25F, 0.3F, 100.0F}) {
    const VoxelGrid grid(box, size);
    const Vec3 end =
        grid.origin + Vec3{static_cast<float>(grid.cells[0]), static_cast<float>(grid.cells[1]),
                           static_cast<float>(grid.cells[2])} *
                          size;
    EXPECT_EQ(min(grid.origin, box.lo), grid.origin);
    EXPECT_EQ(max(end, box.hi), end);
    EXPECT_LT(length(box.lo - grid.origin), 2.6F * size);
    EXPECT_LT(length(end - box.hi), 1.8F * size);
  }
}

TEST(Voxelise, RefusesTooManyVoxels) {
  const auto refused = [](const auto& make) {
    try {
      make();
    } catch (const tools::Error& error) {
      EXPECT_EQ(error.code(), tools::Exit::usage);
      return std::string(error.what()).find("--set size") != std::string::npos;
    }
    return false;
  };
  EXPECT_TRUE(refused([] { VoxelGrid({{0, 0, 0}, {1e6F, 1, 1}}, 0.01F); }));
  const ddgi::Scene scene = ddgi::test::room({50, 50, 50}, 0, 0);
  ddgi::ThreadPool pool(2);
  EXPECT_TRUE(refused([&] { Voxeliser(scene, VoxelGrid(scene.bounds(), 0.02F), pool); }));
}

}  // namespace
}  // namespace gicodec::voxels
