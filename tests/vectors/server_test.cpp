// The tracer: answers that are known, and what it depends on.
#include "dump/error.h"
#include "fields.h"
#include "scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace gicodec::vectors {
namespace {

using Settings = std::vector<std::string>;

kinds::Settings settings(const Settings& given) {
  return {kTracedVectors.name, kTracedVectors.settings, given};
}

VectorOptions few(const ddgi::Scene& scene, const Settings& given = {}) {
  Settings all{"vertices=5x3x6", "rays=24", "warmup=1"};
  all.insert(all.end(), given.begin(), given.end());
  return options_of(settings(all), scene, 1);
}

std::vector<std::byte> traced(const ddgi::Scene& scene, const VectorOptions& options,
                              unsigned threads, std::initializer_list<double> times) {
  VectorServer server(scene, options, threads, {});
  for (const double time : times) server.update(time);
  return server.texels();
}

void expect_share_of_most(Vec3 value, Vec3 expected, float share) {
  EXPECT_NEAR(value.x, expected.x, share * std::max({expected.x, expected.y, expected.z}));
  EXPECT_NEAR(value.y, expected.y, share * std::max({expected.x, expected.y, expected.z}));
  EXPECT_NEAR(value.z, expected.z, share * std::max({expected.x, expected.y, expected.z}));
}

/// What native makes use of.
TEST(VectorServer, OppositeHemispheresSumUpToTheSame) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  VectorServer server(scene, few(scene, {"rays-turned=1"}), 2, {});
  server.update(1);
  std::size_t lit = 0;
  const VectorField& field = server.field();
  for (std::size_t i = 0; i < field.vertices.size(); ++i) {
    if (field.known[i] == 0) continue;
    const auto both = [&](std::size_t hemisphere) {
      const Vectors &a = field.vertices[i][hemisphere], &b = field.vertices[i][hemisphere + 1];
      return a.red + a.green + a.blue + b.red + b.green + b.blue;
    };
    float size = 0;
    for (const Vectors& v : field.vertices[i]) {
      size += length(v.red) + length(v.green) + length(v.blue);
    }
    EXPECT_LE(length(both(0) - both(2)), 1e-5F * size);
    EXPECT_LE(length(both(0) - both(4)), 1e-5F * size);
    lit += length(both(0)) > 1e-2F * size ? 1 : 0;
  }
  EXPECT_GT(lit, field.vertices.size() / 2);
}

/// Of a sky of radiance L all around: L along the axes, as it should be. Between them the weights
/// of §3.2 give L · Σ|n|³.
TEST(VectorServer, AConstantSkyGivesItsRadiance) {
  const ddgi::Scene scene = test::under_sky(0.75F, false);
  for (const bool turned : {false, true}) {
    VectorServer server(
        scene, few(scene, {"vertices=2", "rays=1024", turned ? "rays-turned=1" : "rays-turned=0"}),
        2, {});
    server.update(0);
    EXPECT_EQ(std::ranges::count(server.field().known, 0), 0);
    EXPECT_EQ(server.rays(), 8U * 1024);
    const Vec3 radiance{0.75F, 0.375F, 1.5F};
    ddgi::Random random(1);
    for (std::size_t i = 0; i < 200; ++i) {
      const Vec3 n = i < kHemispheres ? axis_of(i) : test::random_direction(random);
      const Vec3 p{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)};
      const float share =
          std::abs(n.x * n.x * n.x) + std::abs(n.y * n.y * n.y) + std::abs(n.z * n.z * n.z);
      for (const auto way : {Interpolation::trilinear, Interpolation::tricubic}) {
        expect_share_of_most(server.field().irradiance(p, n, way), radiance * share, 0.02F);
      }
    }
  }
}

/// Above a floor that is black and has no end: nothing from below, half from the sides.
TEST(VectorServer, ABlackFloorTakesTheLightFromBelow) {
  const ddgi::Scene scene = test::under_sky(0.75F, true);
  VectorServer server(scene, few(scene, {"vertices=2", "rays=2048"}), 2, {});
  server.update(0);
  EXPECT_EQ(std::ranges::count(server.field().known, 0), 0);
  const Vec3 radiance{0.75F, 0.375F, 1.5F};
  for (std::size_t h = 0; h < kHemispheres; ++h) {
    const float share = h == 2 ? 1.0F : h == 3 ? 0.0F : 0.5F;
    for (const float y : {-1.0F, 0.3F, 1.0F}) {
      const Vec3 value =
          server.field().irradiance({0.2F, y, -0.4F}, axis_of(h), Interpolation::trilinear);
      expect_share_of_most(value, radiance * std::max(share, 0.01F), share > 0 ? 0.03F : 1.1F);
    }
  }
}

/// In a closed room whose walls glow and reflect, radiance is e / (1 − albedo) everywhere.
TEST(VectorServer, LightBouncesUntilItSettles) {
  const ddgi::Scene scene = ddgi::test::room({2, 1.5F, 3}, 0.5F, 0.2F);
  const Settings given{"vertices=3", "rays=512", "form=floats"};
  const auto with = [&](const char* bounces) {
    Settings all = given;
    all.emplace_back(bounces);
    return few(scene, all);
  };
  VectorServer server(scene, with("warmup=40"), 2, {});
  server.update(0);
  for (std::size_t h = 0; h < kHemispheres; ++h) {
    const Vec3 value =
        server.field().irradiance({0.5F, 0, 1}, axis_of(h), Interpolation::trilinear);
    expect_share_of_most(value, {0.4F, 0.4F, 0.4F}, 0.03F);
  }
  const auto settled = server.texels();
  server.update(1);
  EXPECT_EQ(server.texels(), settled);
  // One bounce only: what the walls give off.
  VectorServer first(scene, with("warmup=0"), 2, {});
  first.update(0);
  expect_share_of_most(first.field().irradiance({}, {0, 1, 0}, Interpolation::trilinear),
                       {0.2F, 0.2F, 0.2F}, 0.03F);
}

TEST(VectorServer, IsTheSameForAnyNumberOfThreadsAndAgain) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  for (const Settings& given :
       {Settings{}, Settings{"form=floats", "rays-turned=1"}, Settings{"rays-anew=1"}}) {
    const VectorOptions options = few(scene, given);
    const auto texels = traced(scene, options, 1, {0, 1, 1.5});
    EXPECT_EQ(texels, traced(scene, options, 1, {0, 1, 1.5}));
    EXPECT_EQ(texels, traced(scene, options, 2, {0, 1, 1.5}));
    EXPECT_EQ(texels, traced(scene, options, 5, {0, 1, 1.5}));
  }
}

TEST(VectorServer, RaysAnewMakeNoise) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  const auto twice = [&](const Settings& given) {
    VectorServer server(scene, few(scene, given), 2, {});
    server.update(1);
    auto first = server.texels();
    server.update(1);
    return std::pair(std::move(first), server.texels());
  };
  const auto [still, again] = twice({"warmup=60"});
  EXPECT_EQ(still, again);
  const auto [noisy, other] = twice({"warmup=60", "rays-anew=1"});
  EXPECT_NE(noisy, other);
  EXPECT_NE(noisy, still);
}

TEST(VectorServer, FollowsWhatMovesAndTheSeed) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  const VectorOptions options = few(scene);
  VectorOptions other = options;
  other.gather.seed = 2;
  EXPECT_NE(traced(scene, options, 2, {0}), traced(scene, options, 2, {2}));
  EXPECT_NE(traced(scene, options, 2, {0}), traced(scene, other, 2, {0}));
  EXPECT_NE(traced(scene, options, 2, {0}), traced(scene, few(scene, {"rays-turned=1"}), 2, {0}));
}

TEST(VectorServer, VerticesWithinSolidsHaveNothingToTell) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  for (const char* form : {"form=quantised", "form=floats"}) {
    // The first of each row is within the block.
    const VectorOptions options =
        few(scene, {"vertices=4x2x2", "box=-5,-1,-7,4,1,-4", "rays=64", form});
    VectorServer server(scene, options, 2, {});
    server.update(0);
    const auto texels = server.texels();
    const std::size_t bytes = texels.size() / 16;
    ASSERT_EQ(texels.size(), texture_bytes(test::Held(server).texture()));
    for (std::size_t i = 0; i < 16; ++i) {
      if (i % 4 == 1) continue;  // On the block's side.
      const auto block = std::span(texels).subspan(i * bytes, bytes);
      const bool zero = std::ranges::all_of(block, [](std::byte b) { return b == std::byte{0}; });
      EXPECT_EQ(server.field().known[i] == 0, i % 4 == 0) << i;
      EXPECT_EQ(zero, i % 4 == 0) << i;
    }
  }
}

TEST(VectorSettings, SayWhereVerticesAre) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  const VectorOptions usual = options_of(settings({}), scene, 7);
  EXPECT_EQ(usual.grid, (Grid{16, 16, 16}));
  EXPECT_EQ(usual.box.lo, scene.volume.lo);
  EXPECT_EQ(usual.box.hi, scene.volume.hi);
  EXPECT_EQ(usual.gather.seed, 7U);
  EXPECT_FALSE(usual.floats || usual.gather.turned || usual.gather.anew);
  const VectorOptions options = options_of(
      settings({"vertices=4x2x256", "box=-1,0.5,-2e1,1,3,4", "form=floats", "rays=6"}), scene, 1);
  EXPECT_EQ(options.grid, (Grid{4, 2, 256}));
  EXPECT_EQ(options.box.lo, (Vec3{-1, 0.5F, -20}));
  EXPECT_EQ(options.box.hi, (Vec3{1, 3, 4}));
  EXPECT_TRUE(options.floats);
  const VolumeGeometry geometry = geometry_of({{-1, 0, 2}, {1, 0.5F, 8}}, {3, 2, 4});
  EXPECT_EQ(geometry.origin, (Position{-1, 0, 2}));
  EXPECT_EQ(geometry.spacing, (Position{1, 0.5F, 2}));
}

TEST(VectorSettings, RefuseWhatMakesNoSense) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  for (const char* text : {"vertices=",
                           "vertices=1",
                           "vertices=257",
                           "vertices=4x4",
                           "vertices=4x4x1",
                           "vertices=4x4x4x4",
                           "vertices=4X4X4",
                           "vertices=-4",
                           "vertices=4 ",
                           "vertices=4x4x",
                           "vertices=99999999999",
                           "box=",
                           "box=Scene",
                           "box=0,0,0,1,1",
                           "box=0,0,0,1,1,1,1",
                           "box=0,0,0,1,1,0",
                           "box=0,0,0,1,1,-1",
                           "box=0,0,0,1,nan,1",
                           "box=0,0,0,1,inf,1",
                           "box=-2e6,0,0,1,1,1",
                           "box=0,0,0,1,1,2e6",
                           "box=0;0;0;1;1;1",
                           "box=0,0,0,1,1,1 ",
                           "form=half",
                           "rays=5",
                           "rays=65537",
                           "rays-turned=2",
                           "rays-anew=yes",
                           "warmup=101"}) {
    try {
      static_cast<void>(options_of(settings({text}), scene, 1));
      ADD_FAILURE() << text;
    } catch (const tools::Error& error) {
      EXPECT_EQ(error.code(), tools::Exit::usage) << text;
      const std::string name = std::string(text).substr(0, std::string(text).find('='));
      EXPECT_NE(std::string(error.what()).find("--set " + name), std::string::npos) << text;
    }
  }
}

TEST(VectorSource, GivesFramesOfItsVolume) {
  for (const bool floats : {false, true}) {
    const auto trace = [&](unsigned threads) {
      return kTracedVectors.trace(
          {ddgi::test::busy_room(),
           settings({"vertices=4x3x2", "rays=8", floats ? "form=floats" : "form=quantised"}), 1,
           threads});
    };
    const kinds::Feed feed = trace(1), other = trace(3);
    ASSERT_EQ(feed.volumes.size(), 1U);
    ASSERT_FALSE(feed.remarks.empty());
    EXPECT_NE(feed.remarks.front().find("4x3x2 vertices"), std::string::npos);
    const kinds::FeedVolume& volume = feed.volumes.front();
    EXPECT_EQ(validate(volume.desc), Status::ok);
    EXPECT_EQ(volume.desc.kind, kKindIrradianceVectors);
    EXPECT_EQ(validate(volume.geometry), Status::ok);
    for (const double time : {0.0, 1.0}) {
      const auto textures = feed.next({time, {}}).volumes.at(0).textures;
      ASSERT_EQ(textures.size(), 1U);
      EXPECT_EQ(textures[0].size(), texture_bytes(textures_of(volume.desc)[0]->desc));
      EXPECT_EQ(textures, other.next({time, {}}).volumes.at(0).textures);
    }
  }
}

}  // namespace
}  // namespace gicodec::vectors
