#include "rooms.h"

#include "photons/radius.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numeric>

namespace gicodec::photons {
namespace {

using namespace test;

/// Sum of the powers of a batch, for one watt.
Vec3 power_of(const Shot& shot, PhotonForm form) {
  Vec3 sum;
  for (std::size_t at = 0; at < shot.records.size(); at += kPhotonBytes) {
    const Photon p =
        unpack_photon(ConstPhotonBytes(&shot.records[at], kPhotonBytes), shot.batch, form);
    sum += Vec3{p.power[0], p.power[1], p.power[2]} * p.normalisation;
  }
  return sum / static_cast<float>(shot.batch.emitted);
}

Shot shoot_first(const ddgi::RayScene& scene, const ShotOptions& options, unsigned threads = 2,
                 const PhotonBatch& former = {}) {
  ddgi::ThreadPool pool(threads);
  const Sphere reach = sphere_around(scene.scene().bounds());
  const Emitter emitter = project(scene, reach, 0, options.seed, pool).emitter;
  return shoot(scene, emitter, 0, 0, 1, former, options, pool);
}

Scene with(const Light& light) {
  Scene s = lit_room();
  s.lights = {light};
  return s;
}

TEST(PhotonTracer, PowerIsThatOfTheLight) {
  // Of a watt a share of the albedo meets surfaces a second time, of that a share a third time.
  constexpr float kStored = kAlbedo / (1 - kAlbedo);
  for (const Light& light : {
           Light{.type = LightType::point, .colour = {1.5F, 1, 0.5F}, .position = {1, 0, 0}},
           Light{.type = LightType::spot,
           .colour = {1.5F, 1, 0.5F},
           .position = {1, 0, 0},
           .cos_inner = 0.9F,
           .cos_outer = 0.3F},
           Light{.type = LightType::area,
           .colour = {1.5F, 1, 0.5F},
           .position = {0, 1.9F, 0},
           .half_u = {1, 0, 0},
           .half_v = {0, 0, 1}},
       }) {
    const Scene s = with(light);
    const ddgi::RayScene scene(s);
    for (const PhotonForm form : {PhotonForm::halves, PhotonForm::shared_exponent}) {
      const Shot shot = shoot_first(scene, {.emitted = 20000, .form = form});
      const Vec3 power = power_of(shot, form);
      EXPECT_NEAR(power.x, 1.5F * kStored, 0.03F);
      EXPECT_NEAR(power.y, kStored, 0.02F);
      EXPECT_NEAR(power.z, 0.5F * kStored, 0.01F);
      EXPECT_NEAR(static_cast<double>(shot.records.size() / kPhotonBytes), 20000 * kStored, 400);
    }
  }
}

TEST(PhotonTracer, WattsAreTheIntegralOfTheLight) {
  const Sphere reach{{}, 2};
  const Vec3 white{1, 1, 1};
  EXPECT_NEAR(Emitter({.type = LightType::point, .colour = white}, reach).watts(), 4 * ddgi::kPi,
              1e-5F);
  EXPECT_NEAR(Emitter({.type = LightType::sun, .colour = white}, reach).watts(), 16, 1e-5F);
  EXPECT_NEAR(
      Emitter(
          {.type = LightType::area, .colour = white, .half_u = {2, 0, 0}, .half_v = {0, 0, 0.5F}},
          reach)
          .watts(),
      4 * ddgi::kPi, 1e-4F);
  const Light spot{.type = LightType::spot, .colour = white, .cos_inner = 0.9F, .cos_outer = 0.2F};
  double sum = 0;
  for (int i = 0; i < 100000; ++i) {
    const double cosine = 0.2 + 0.8 * (i + 0.5) / 100000;
    sum += ddgi::smoothstep(0.2F, 0.9F, static_cast<float>(cosine));
  }
  EXPECT_NEAR(Emitter(spot, reach).watts(), 2 * ddgi::kPi * 0.8 * sum / 100000, 1e-3);
  // And rays go where it shines: the mean cosine is that of the light.
  double light = 0, weight = 0, rays = 0;
  for (std::uint32_t i = 0; i < 100000; ++i) {
    const float cosine = 0.2F + 0.8F * (static_cast<float>(i) + 0.5F) / 100000;
    const float shine = ddgi::smoothstep(0.2F, 0.9F, cosine);
    light += shine * cosine;
    weight += shine;
    rays -= Emitter(spot, reach).emit(even_numbers(1, i)).direction.y;
  }
  EXPECT_NEAR(rays / 100000, light / weight, 1e-3);
}

/// A room without a roof but for a slab with a hole.
Scene roofed(float hole) {
  Scene s;
  const std::uint32_t wall = s.add_material({.name = "wall", .colour = {0.5F, 0.5F, 0.5F}});
  ddgi::MeshBuilder floor(wall), roof(wall);
  floor.box({-10, -1, -10}, {10, 0, 10});
  for (const float side : {-1.0F, 1.0F}) {
    roof.box({std::min(side * hole, side * 10), 3, -10},
             {std::max(side * hole, side * 10), 3.2F, 10});
  }
  s.add_object({.name = "house", .meshes = {s.add_mesh(floor.take()), s.add_mesh(roof.take())}});
  s.lights.push_back({.type = LightType::sun, .colour = {1, 1, 1}, .direction = {0, -1, 0}});
  return s;
}

TEST(PhotonTracer, ASunShootsThroughTheHoleInTheRoof) {
  const Scene s = roofed(2);
  const ddgi::RayScene scene(s);
  ddgi::ThreadPool pool(2);
  const Sphere reach = sphere_around(s.bounds());
  const Projection sun = project(scene, reach, 0, 1, pool);
  // The hole is 4 × 20 m, its cells a little more.
  EXPECT_GT(sun.emitter.watts(), 4 * 20);
  EXPECT_LT(sun.emitter.watts(), 6 * 22);
  // The same light comes in as with photons that are shot everywhere.
  const auto light = [&](const Emitter& emitter) {
    const Shot shot =
        shoot(scene, emitter, 0, 0, 1, {}, {.emitted = 200000, .capacity = 1000000}, pool);
    return power_of(shot, PhotonForm::halves).x * emitter.watts();
  };
  const float everywhere = light(Emitter(s.lights[0], reach));
  EXPECT_NEAR(light(sun.emitter), everywhere, 0.04F * everywhere);
}

TEST(PhotonTracer, TheNumberOfThreadsChangesNoBit) {
  const Scene s = ddgi::test::busy_room();
  const ddgi::RayScene scene(s);
  const Shot one = shoot_first(scene, {.emitted = 5000}, 1);
  EXPECT_GT(one.records.size(), 1000 * kPhotonBytes);
  for (const unsigned threads : {2U, 5U}) {
    const Shot more = shoot_first(scene, {.emitted = 5000}, threads);
    EXPECT_EQ(more.records, one.records);
    EXPECT_EQ(more.batch, one.batch);
  }
  EXPECT_NE(shoot_first(scene, {.emitted = 5000, .seed = 2}).records, one.records);
}

TEST(PhotonTracer, WhatThereIsNoRoomForIsStoodFor) {
  const Scene s = lit_room();
  const ddgi::RayScene scene(s);
  const Shot whole = shoot_first(scene, {.emitted = 20000});
  const Shot part = shoot_first(scene, {.emitted = 20000, .capacity = 1000});
  EXPECT_EQ(part.records.size(), 1000 * kPhotonBytes);
  const float expected = power_of(whole, PhotonForm::halves).y;
  EXPECT_NEAR(power_of(part, PhotonForm::halves).y, expected, 0.03F * expected);
}

RC_GTEST_PROP(PhotonRadius, IsTheDistanceToTheNeighbour, ()) {
  std::vector<Vec3> points(*rc::gen::inRange<std::size_t>(1, 80));
  for (Vec3& p : points) {
    const auto v = [] { return static_cast<float>(*rc::gen::inRange(-4, 5)); };
    p = {v(), v(), v()};
  }
  const auto neighbours = *rc::gen::inRange<std::uint32_t>(1, 12);
  const float most = static_cast<float>(*rc::gen::inRange(1, 9));
  ddgi::ThreadPool pool(2);
  const auto found = neighbour_distances(points, neighbours, most, pool);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<float> distances;
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (j != i) distances.push_back(ddgi::length(points[j] - points[i]));
    }
    std::sort(distances.begin(), distances.end());
    const float expected = distances.size() < neighbours ? most : distances[neighbours - 1];
    RC_ASSERT(found[i] == std::min(expected, most));
  }
}

TEST(PhotonRadius, IsRoundedToFewBits) {
  for (const float v : {0.0F, 1.0F, 1.0625F, 1.9375F, 1.97F, 0.3F}) {
    const float rounded = round_fraction(v, 3);
    EXPECT_NEAR(rounded, v, v / 16);
    EXPECT_EQ(round_fraction(rounded, 3), rounded);
  }
  EXPECT_EQ(round_fraction(1.97F, 3), 2);
  EXPECT_EQ(round_fraction(1.1F, 0), 1);
}

TEST(PhotonTracer, KeepsTheFormerBoxWhereItIsHardlyLarger) {
  const Scene s = lit_room();
  const ddgi::RayScene scene(s);
  const PhotonBatch own = shoot_first(scene, {.emitted = 5000}).batch;
  PhotonBatch former = own;
  former.minimum[0] -= 0.1F * own.extent[0];
  former.extent[0] *= 1.2F;
  const Shot kept = shoot_first(scene, {.emitted = 5000}, 2, former);
  EXPECT_EQ(kept.batch.minimum, former.minimum);
  EXPECT_NEAR(kept.batch.extent[0], former.extent[0], 1e-4F);
  former.extent[0] = 2 * own.extent[0];
  EXPECT_EQ(shoot_first(scene, {.emitted = 5000}, 2, former).batch, own);
  former.extent[0] = 0.9F * own.extent[0];
  EXPECT_EQ(shoot_first(scene, {.emitted = 5000}, 2, former).batch, own);
}

}  // namespace
}  // namespace gicodec::photons
