#include "dump/error.h"
#include "halves.h"

#include <gtest/gtest.h>

namespace gicodec::maps {
namespace {

using test::halves;

TEST(MapServer, FramesAreTheSameForAnyNumberOfThreads) {
  for (const std::vector<std::string>& way :
       {std::vector<std::string>{"way=bases"},
        {"way=map", "gather=texels", "rays-anew=1"},
        {"way=map", "gather=bases", "format=A2B10G10R10_UNORM_PACK32"}}) {
    std::vector<std::vector<std::vector<std::byte>>> frames;
    for (const unsigned threads : {1U, 2U, 5U}) {
      const ddgi::Scene scene = halves();
      MapServer server(scene, test::options(way), threads, {});
      server.update(0);
      server.update(0.2);
      frames.push_back(server.textures());
    }
    EXPECT_EQ(frames[0], frames[1]) << way.front();
    EXPECT_EQ(frames[0], frames[2]) << way.front();
  }
}

TEST(MapServer, LightInAGlowingRoomIsTheSumOfItsBounces) {
  constexpr float kAlbedo = 0.5F, kGlow = 0.25F;
  const ddgi::Scene scene = ddgi::test::room({2, 2, 2}, kAlbedo, kGlow);
  for (const char* gathered : {"gather=texels", "gather=bases"}) {
    MapServer server(scene,
                     test::options({"way=map", "format=R16G16B16A16_SFLOAT", "warmup=0", gathered}),
                     2, {});
    float sum = 0, share = 1;
    for (int bounce = 0; bounce < 5; ++bounce) {
      server.update(0);
      sum += kGlow * share;
      share *= kAlbedo;
      for (const MapTexel& texel : server.texels()) {
        ASSERT_NEAR(server.values()[texel.place].y, sum, 0.01F * sum) << gathered << " " << bounce;
      }
    }
  }
}

TEST(MapServer, DirectLightIsNotInTheMap) {
  ddgi::Scene scene = ddgi::test::room({2, 2, 2}, 0, 0);  // black: nothing is reflected
  scene.lights.push_back(
      {.type = ddgi::LightType::point, .colour = {9, 9, 9}, .position = {0, 0, 0}});
  MapServer server(scene, test::options({"way=map", "gather=texels"}), 2, {});
  server.update(0);
  for (const Vec3 value : server.values()) ASSERT_EQ(value, Vec3{});
  EXPECT_GT(server.count().shadow_rays, 0U);
}

TEST(MapServer, FixedRaysOfALitRoomThatStaysRepeatBitForBit) {
  ddgi::Scene scene = halves();
  scene.animate = nullptr;
  for (const bool anew : {false, true}) {
    MapServer server(scene,
                     test::options({"way=map", "gather=texels",
                                    anew ? "rays-anew=1" : "rays-anew=0", "warmup=40"}),
                     2, {});
    server.update(0);
    const auto before = server.textures();
    server.update(1);
    EXPECT_EQ(before == server.textures(), !anew);
  }
}

TEST(MapServer, LightMovesFromOneHalfToTheOtherNowhere) {
  const ddgi::Scene scene = halves();
  MapServer server(scene, test::options({"way=bases", "warmup=3"}), 2, {});
  server.update(0);
  ddgi::RayScene rays(scene);
  rays.set_state(scene.state_at(0));
  float dark = 0, lit = 0;
  for (const MapTexel& texel : server.texels()) {
    const Vec3 at = point_of(server.map(), rays, texel).position;
    const float value = server.values()[texel.place].y;
    if (at.x < -0.5F) dark = std::max(dark, value);
    if (at.x > 0.5F) lit = std::max(lit, value);
  }
  EXPECT_GT(lit, 0.05F);
  EXPECT_LT(dark, 1e-3F) << "the lamps are in the other half";
}

TEST(MapServer, WhatAnotherObjectCoversByALittleIsNotDark) {
  // Two slabs that move, one of which lies within the other along an edge, 2 cm below its top.
  ddgi::Scene scene = ddgi::test::room({4, 3, 4}, 0.5F, 0.25F);
  for (const float side : {-1.0F, 1.0F}) {
    ddgi::MeshBuilder slab(0);
    slab.box({-1.1F, -0.2F, -1}, {1.1F, 0.01F * side, 1});
    scene.add_object({.name = "slab",
                      .meshes = {scene.add_mesh(slab.take())},
                      .transform = ddgi::translation({side, 0, 0}),
                      .dynamic = true});
  }
  ddgi::RayScene rays(scene);
  for (const char* gathered : {"gather=texels", "gather=bases"}) {
    MapServer server(scene, test::options({"way=map", "rays=64", gathered}), 2, {});
    server.update(0);
    std::size_t covered = 0;
    for (const MapTexel& texel : server.texels()) {
      const MapPoint at = point_of(server.map(), rays, texel);
      const bool top = at.geometric_normal.y > 0.9F && std::abs(at.position.y) < 0.1F;
      if (!top) continue;
      covered += at.position.x > -0.1F && at.position.y < 0;
      EXPECT_GT(server.values()[texel.place].y, 0.2F) << at.position.x;
    }
    EXPECT_GT(covered, 0U);
  }
}

TEST(MapServer, SettingsThatMakeNoSenseAreRefused) {
  EXPECT_THROW(test::options({"way=bases", "gather=texels"}), tools::Error);
  EXPECT_THROW(test::options({"size=8"}), tools::Error);
  EXPECT_THROW(test::options({"format=R8_UNORM"}), tools::Error);
  const ddgi::Scene scene = halves();
  EXPECT_THROW(MapServer(scene, test::options({"size=512", "spacing=0.01"}), 2, {}), tools::Error)
      << "more bases than can be";
}

}  // namespace
}  // namespace gicodec::maps
