#include "ddgi/scenes.h"
#include "dump/error.h"
#include "halves.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace gicodec::maps {
namespace {

using test::halves;

/// A built-in scene, made once: with thousands of charts of all shapes.
const ddgi::Scene& villa() {
  static const ddgi::Scene scene = ddgi::make_villa();
  return scene;
}
const Parameterisation& villa_map() {
  static const Parameterisation map(villa(), 200, 300);
  return map;
}

TEST(Parameterisation, NoTwoChartsShareATexel) {
  const Parameterisation& map = villa_map();
  std::vector<std::uint8_t> taken(std::size_t{map.width()} * map.height());
  ASSERT_GT(map.rects().size(), 1000U);
  for (const ChartRect& rect : map.rects()) {
    ASSERT_GE(rect.width, 1U);
    ASSERT_GE(rect.height, 1U);
    ASSERT_LE(rect.x + rect.width, map.width());
    ASSERT_LE(rect.y + rect.height, map.height());
    for (std::uint32_t y = rect.y; y < rect.y + rect.height; ++y) {
      for (std::uint32_t x = rect.x; x < rect.x + rect.width; ++x) {
        ASSERT_EQ(taken[x + std::size_t{map.width()} * y]++, 0) << x << ", " << y;
      }
    }
  }
}

TEST(Parameterisation, EveryTriangleLiesInItsChart) {
  const Parameterisation& map = villa_map();
  std::size_t outside = 0, none = 0;
  for (std::uint32_t t = 0; t < map.scene().positions.size(); ++t) {
    const std::uint32_t chart = map.scene().chart_of[t];
    if (chart == SceneCharts::kNone) {
      ++none;
      continue;
    }
    const ChartRect& rect = map.rects()[chart];
    for (const Vec2 at : map.corners(t)) {
      const bool in = at.x >= static_cast<float>(rect.x) && at.y >= static_cast<float>(rect.y) &&
                      at.x <= static_cast<float>(rect.x + rect.width - 1) &&
                      at.y <= static_cast<float>(rect.y + rect.height - 1);
      outside += in ? 0 : 1;
    }
  }
  EXPECT_EQ(outside, 0U);
  EXPECT_LT(none, map.scene().positions.size() / 20) << "triangles without an area";
}

TEST(Parameterisation, ALookUpReadsTexelsOfItsChartThatAreThere) {
  const Parameterisation& map = villa_map();
  std::vector<std::uint32_t> triangle_at(std::size_t{map.width()} * map.height(),
                                         SceneCharts::kNone);
  for (const MapTexel& texel : map.texels()) triangle_at[texel.place] = texel.triangle;
  rc::check([&] {
    const Instance& instance = *rc::gen::elementOf(map.scene().instances);
    RC_PRE(instance.triangles > 0);
    ddgi::Surface at;
    at.object = instance.object, at.mesh = instance.mesh;
    at.triangle = *rc::gen::inRange(0U, instance.triangles);
    // Also a little beyond the edges, as rays meet triangles.
    at.u = static_cast<float>(*rc::gen::inRange(-2, 1002)) / 1000;
    at.v = static_cast<float>(*rc::gen::inRange(-2, 1002)) / 1000 * (1 - at.u);
    const std::uint32_t chart = map.scene().chart_of[instance.first + at.triangle];
    RC_PRE(chart != SceneCharts::kNone);
    const Parameterisation::Taps taps = map.taps(at);
    float sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      sum += taps.weight[i];
      if (taps.weight[i] < 1e-3F) continue;
      RC_ASSERT(triangle_at[taps.place[i]] != SceneCharts::kNone);
      RC_ASSERT(map.scene().chart_of[triangle_at[taps.place[i]]] == chart);
    }
    RC_ASSERT(std::abs(sum - 1) < 1e-5F);
  });
}

TEST(Parameterisation, ALookUpAtATexelsSampleIsThatTexel) {
  const ddgi::Scene scene = halves();
  const Parameterisation map(scene, 64, 64);
  std::vector<Vec3> values(64 * 64);
  const std::vector<std::uint8_t> all(values.size(), 1);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = {static_cast<float>(i), 1, 0};
  std::size_t same = 0;
  for (const MapTexel& texel : map.texels()) {
    const Instance& instance = map.instance_of(texel.triangle);
    ddgi::Surface at;
    at.object = instance.object, at.mesh = instance.mesh;
    at.triangle = texel.triangle - instance.first;
    at.u = texel.u, at.v = texel.v;
    const Vec3 found = blend(map.taps(at), values, all);
    ASSERT_NEAR(found.y, 1, 1e-5F);
    same += std::abs(found.x - static_cast<float>(texel.place)) < 0.1F ? 1 : 0;
  }
  // Others are at the rim, where the sample is the nearest point of the surface.
  EXPECT_GT(same, map.texels().size() / 3);
}

TEST(Parameterisation, WallsAreChartsThatAreCutWhereTheyAreLarge) {
  const SceneCharts charts = make_charts(ddgi::test::room({2, 2, 2}, 0.5F, 0, 4));
  EXPECT_EQ(charts.charts.size(), 24U);
  for (const Chart& chart : charts.charts) {
    EXPECT_EQ(chart.triangles.size(), 8U);
    EXPECT_NEAR(chart.size.x, 2, 1e-4F);
    EXPECT_NEAR(chart.size.y, 2, 1e-4F);
  }
}

TEST(Parameterisation, DistancesOnASurfaceAreThoseInTheMap) {
  const ddgi::Scene scene = halves();
  const Parameterisation map(scene, 128, 128);
  for (std::uint32_t t = 0; t < map.scene().positions.size(); ++t) {
    const std::uint32_t number = map.scene().chart_of[t];
    if (number == SceneCharts::kNone) continue;
    const Chart& chart = map.scene().charts[number];
    if (map.rects()[number].width == 1 || map.rects()[number].height == 1) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2 a = map.corners(t)[i], b = map.corners(t)[(i + 1) % 3];
      const float metres =
          length(map.scene().positions[t][(i + 1) % 3] - map.scene().positions[t][i]);
      const float texels = std::hypot(b.x - a.x, b.y - a.y);
      EXPECT_LE(texels, metres * map.density() * chart.density * 1.001F + 1e-3F);
      EXPECT_GE(texels, metres * map.density() * chart.density * 0.59F - 1e-3F);
    }
  }
}

TEST(Parameterisation, BothEndsFindTheSameAndKnowOthersByTheirHash) {
  const Parameterisation once(halves(), 64, 64), again(halves(), 64, 64);
  EXPECT_EQ(once.hash(), again.hash());
  ASSERT_EQ(once.texels().size(), again.texels().size());
  EXPECT_NE(once.hash(), Parameterisation(halves(), 64, 80).hash());
  ddgi::Scene other = halves();
  other.meshes[0].positions[0].x += 0.5F;
  EXPECT_NE(once.hash(), Parameterisation(other, 64, 64).hash());
}

TEST(Parameterisation, AMapThatIsTooSmallForTheChartsIsRefused) {
  EXPECT_THROW(Parameterisation(villa(), 32, 32), tools::Error);
}

TEST(Parameterisation, BrokenMeshesHaveNoCharts) {
  ddgi::Scene scene = halves();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  scene.meshes[0].positions[0] = {nan, nan, nan};
  scene.meshes[0].positions[1] = {1e30F, -1e30F, 1e30F};
  const Parameterisation map(scene, 64, 64);
  ddgi::Surface at;
  at.object = 77;
  EXPECT_EQ(map.taps(at).weight[0], 0);
  at.object = 0, at.triangle = 0xFFFFFFFFU;
  EXPECT_EQ(map.taps(at).weight[0], 0);
  at.triangle = 0, at.u = nan;
  for (const std::uint32_t place : map.taps(at).place) EXPECT_LT(place, 64U * 64U);
}

}  // namespace
}  // namespace gicodec::maps
