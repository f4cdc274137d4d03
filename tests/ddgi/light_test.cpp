// Light with analytic answers.
#include "ddgi/lighting.h"
#include "ddgi/octahedral.h"
#include "rooms.h"

#include <gtest/gtest.h>

namespace gicodec::ddgi {
namespace {

using test::for_core_texels;
using test::room;
using test::Traced;

// Everything that is seen has the same radiance, so every texel of every probe holds it.
TEST(WhiteFurnace, EmissionAloneIsExact) {
  Traced traced(room({4, 3, 5}, 0, 0.3F), {.rays = 64});
  traced.volume.update(0);
  ASSERT_EQ(traced.volume.active_probes().size(), 60U);
  const auto expected = static_cast<float>(encode_gamma5(0.3F));
  for_core_texels(traced.volume.textures(), traced.volume.active_probes(),
                  [&](auto, auto, auto, auto r, auto g, auto b) {
                    EXPECT_EQ(r, expected);
                    EXPECT_EQ(g, expected);
                    EXPECT_EQ(b, expected);
                  });
}

// L = Le / (1 - albedo). The iteration runs on codes: a fixed point may lie half a code over
// 1 - albedo below the true one, and is itself rounded.
TEST(WhiteFurnace, AllBouncesAddUp) {
  for (const float albedo : {0.25F, 0.5F, 0.7F}) {
    Traced traced(room({4, 3, 5}, albedo, 0.1F), {.rays = 64});
    const auto statistics = traced.volume.update(0);
    EXPECT_GT(statistics.bounces, 2U);
    EXPECT_LT(statistics.bounces, 64U);
    const auto expected = static_cast<int>(encode_gamma5(0.1F / (1 - albedo)));
    const int slack = static_cast<int>(0.5F / (1 - albedo) + 1);
    for_core_texels(traced.volume.textures(), traced.volume.active_probes(),
                    [&](auto, auto, auto, auto r, auto, auto) {
                      EXPECT_LE(static_cast<int>(r), expected + 1);
                      EXPECT_GE(static_cast<int>(r), expected - slack);
                    });
  }
}

TEST(WhiteFurnace, NoisyModeAgrees) {
  Traced traced(room({4, 3, 5}, 0.5F, 0.1F),
                {.mode = TraceMode::noisy, .rays = 64, .hysteresis = 0.5F});
  for (int i = 0; i < 40; ++i) traced.volume.update(0);
  const auto expected = static_cast<int>(encode_gamma5(0.2F));
  for_core_texels(
      traced.volume.textures(), traced.volume.active_probes(),
      [&](auto, auto, auto, auto r, auto, auto) { EXPECT_NEAR(static_cast<int>(r), expected, 2); });
}

constexpr Vec3 kHalf{4, 3, 5};
constexpr Vec3 kLamp{1.2F, 1.0F, -1.7F};
constexpr float kAlbedo = 0.5F, kIntensity = 2;

/// Radiance that a point light gives the wall a ray meets, in closed form.
double wall_radiance(Vec3 from, Vec3 d) {
  const auto exit = [](float o, float dir, float half) {
    return dir > 0 ? (half - o) / dir : dir < 0 ? (-half - o) / dir : 1e30F;
  };
  const float tx = exit(from.x, d.x, kHalf.x), ty = exit(from.y, d.y, kHalf.y),
              tz = exit(from.z, d.z, kHalf.z);
  const float t = std::min({tx, ty, tz});
  const Vec3 p = from + d * t, to = kLamp - p;
  const Vec3 n = t == tx   ? Vec3{d.x > 0 ? -1.0F : 1.0F, 0, 0}
                 : t == ty ? Vec3{0, d.y > 0 ? -1.0F : 1.0F, 0}
                           : Vec3{0, 0, d.z > 0 ? -1.0F : 1.0F};
  const float squared = dot(to, to);
  return kAlbedo / kPi * kIntensity * dot(n, to) / (squared * std::sqrt(squared));
}

// One bounce from a point light in an empty box, against the integral of the form factor.
TEST(PointLight, OneBounceMatchesTheFormFactor) {
  Scene scene = room(kHalf, kAlbedo, 0);
  scene.lights.push_back({.type = LightType::point,
                          .colour = {kIntensity, kIntensity, kIntensity},
                          .position = kLamp});
  scene.grid = {3, 2, 3};
  Traced traced(std::move(scene), {.rays = 8192, .max_bounces = 1});
  traced.volume.update(0);
  const auto fine = fibonacci_directions(20000);
  std::vector<double> radiance(fine.size());
  std::uint32_t at = ~0U;
  for_core_texels(
      traced.volume.textures(), traced.volume.active_probes(),
      [&](auto probe, auto x, auto y, auto r, auto, auto) {
        if (probe != at) {
          const Vec3 position = traced.volume.shape().position(probe);
          for (std::size_t i = 0; i < fine.size(); ++i)
            radiance[i] = wall_radiance(position, fine[i]);
          at = probe;
        }
        if ((x + y) % 3) return;  // a third of the texels is enough
        const Vec3 n = texel_direction(x, y, 8);
        double sum = 0, weight = 0;
        for (std::size_t i = 0; i < fine.size(); ++i) {
          const double w = std::max(0.0F, dot(n, fine[i]));
          sum += w * radiance[i];
          weight += w;
        }
        const double expected = sum / weight;
        EXPECT_NEAR(decode_gamma5(static_cast<std::uint32_t>(r)), expected, 0.02 * expected)
            << "probe " << probe << " texel " << x << " " << y;
      });
}

TEST(DirectLight, PointAndShadow) {
  Scene scene = room(kHalf, kAlbedo, 0);
  scene.lights.push_back({.type = LightType::point, .colour = {1, 2, 3}, .position = {0, 1, 0}});
  const RayScene rays(scene);
  const auto floor = rays.intersect({0.5F, 0, 0}, {0, -1, 0}, 0);
  ASSERT_TRUE(floor);
  EXPECT_FALSE(floor->back);
  EXPECT_NEAR(floor->distance, 3, 1e-6F);
  std::uint64_t count = 0;
  const Vec3 light = direct_light(rays, *floor, count);
  const double squared = 16.25, expected = 4 / std::sqrt(squared) / squared / 3.14159265;
  EXPECT_NEAR(light.x, expected, 1e-5);
  EXPECT_NEAR(light.z, 3 * expected, 3e-5);
  EXPECT_EQ(count, 1U);
  EXPECT_TRUE(rays.occluded({0, 0, 0}, {0, 1, 0}, 4));
  EXPECT_FALSE(rays.occluded({0, 0, 0}, {0, 1, 0}, 2.9F));
}

TEST(DirectLight, SunSpotAndArea) {
  Scene scene;
  const std::uint32_t white = scene.add_material({.name = "white"});
  MeshBuilder floor(white);
  floor.patch({-20, 0, 20}, {40, 0, 0}, {0, 0, -40});
  scene.add_object({.name = "floor", .meshes = {scene.add_mesh(floor.take())}});
  const auto lit = [&](Light light, Vec3 over) {
    scene.lights = {light};
    const RayScene rays(scene);
    std::uint64_t count = 0;
    return direct_light(rays, *rays.intersect(over, {0, -1, 0}, 0), count).x;
  };
  EXPECT_NEAR(lit({.type = LightType::sun, .colour = {3, 3, 3}, .direction = normalize({1, -1, 0})},
                  {0, 1, 0}),
              3 * std::sqrt(0.5F) / kPi, 1e-5F);
  const Light spot{.type = LightType::spot,
                   .colour = {1, 1, 1},
                   .position = {0, 2, 0},
                   .direction = {0, -1, 0},
                   .cos_inner = 0.95F,
                   .cos_outer = 0.9F};
  EXPECT_NEAR(lit(spot, {0, 1, 0}), 0.25F / kPi, 1e-5F);
  EXPECT_EQ(lit(spot, {3, 1, 0}), 0);
  // Far away, an area light is a point of intensity radiance · area.
  const Light area{.type = LightType::area,
                   .colour = {2, 2, 2},
                   .position = {0, 10, 0},
                   .direction = {0, -1, 0},
                   .half_u = {0.25F, 0, 0},
                   .half_v = {0, 0, 0.25F}};
  EXPECT_NEAR(lit(area, {0, 1, 0}), 2 * 0.25F / 100 / kPi, 1e-5F);
}

}  // namespace
}  // namespace gicodec::ddgi
