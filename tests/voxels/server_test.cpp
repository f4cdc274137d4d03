// The tracer: answers that are known, and what it depends on.
#include "dump/error.h"
#include "octrees.h"

#include <gtest/gtest.h>

namespace gicodec::voxels {
namespace {

using Given = std::vector<std::string>;

kinds::Settings settings(const Given& given) {
  return {kTracedVoxels.name, kTracedVoxels.settings, given};
}

VoxelOptions few(const ddgi::Scene& scene, const Given& given = {}) {
  Given all{"size=1.5", "rays=6", "warmup=1"};
  all.insert(all.end(), given.begin(), given.end());
  return options_of(settings(all), scene, 1);
}

using Bytes = std::vector<std::byte>;
std::pair<Bytes, Bytes> traced(const ddgi::Scene& scene, const VoxelOptions& options,
                               unsigned threads, std::initializer_list<double> times) {
  VoxelServer server(scene, options, threads, {});
  for (const double time : times) server.update(time);
  const BrickPool& pool = server.pool();
  return {{pool.bricks().begin(), pool.bricks().end()}, {pool.light().begin(), pool.light().end()}};
}

/// In a closed room whose walls glow and reflect, radiance is e / (1 − albedo) everywhere.
TEST(VoxelServer, LightBouncesUntilItSettles) {
  const ddgi::Scene scene = ddgi::test::room({2, 1.5F, 3}, 0.5F, 0.2F);
  VoxelServer server(scene, few(scene, {"size=0.9", "warmup=40", "form=halves"}), 2, {});
  server.update(0);
  ddgi::Random random(1);
  for (int i = 0; i < 100; ++i) {
    // On the ceiling, away from voxels with a face outside of the room.
    const Vec3 place{random.in(-0.9F, 0.9F), 1.5F, random.in(-1.5F, 1.5F)};
    test::expect_near(server.field().irradiance(place, {0, -1, 0}, 0), {0.4F, 0.4F, 0.4F}, 0.004F);
  }
  const std::uint64_t rays = server.rays();
  EXPECT_LE(rays, server.octree()[0].keys.size() * 6 * 6);
  const Octree before = server.octree();
  server.update(1);
  EXPECT_EQ(server.octree()[0].records, before[0].records);
  EXPECT_EQ(server.rays(), rays);
  VoxelServer first(scene, few(scene, {"size=0.9", "warmup=0", "form=halves"}), 2, {});
  first.update(0);
  test::expect_near(first.field().irradiance({0, 1.5F, 0}, {0, -1, 0}, 0), {0.2F, 0.2F, 0.2F},
                    0.002F);
}

/// Black ground below a sky of one radiance: all of it from above, nothing from within the ground,
/// and half from the sides.
void expect_sky_over_ground(bool all_directions) {
  ddgi::Scene scene;
  const Vec3 sky{0.5F, 1, 2};
  scene.sky = {.zenith = sky, .horizon = sky, .ground = sky};
  ddgi::MeshBuilder ground(scene.add_material({.name = "black", .colour = {}}));
  ground.box({-500, -10, -500}, {500, 0, 500});
  scene.add_object({.name = "ground", .meshes = {scene.add_mesh(ground.take())}});
  scene.volume = {{-2, -2, -2}, {2, 2, 2}};
  const std::string which = all_directions ? "all-directions=1" : "all-directions=0";
  VoxelServer server(scene, few(scene, {"size=1", "rays=256", "form=halves", which}), 2, {});
  server.update(0);
  const OctreeLevel& leaves = server.octree()[0];
  EXPECT_EQ(leaves.keys.size(), 49U);                  // one layer within 6 m
  const std::uint64_t one = 256 * leaves.keys.size();  // direction of each
  if (all_directions) {
    EXPECT_GT(server.rays(), 5 * one);  // of the sixth until most see insides
    EXPECT_LE(server.rays(), 6 * one);
  } else {
    EXPECT_EQ(server.rays(), one);
  }
  const VoxelCode code(VoxelForm::halves);
  const float gathered = all_directions ? 1 : 0;
  for (std::size_t i = 0; i < leaves.keys.size(); ++i) {
    const Voxel voxel = code.load(&leaves.records[i * code.bytes()]);
    test::expect_near(voxel.color[2], sky, 0.01F);
    EXPECT_EQ(voxel.color[3], Vec3{});
    for (const std::size_t side : {0U, 1U, 4U, 5U}) {
      test::expect_near(voxel.color[side], sky * (0.5F * gathered), 0.02F * gathered);
    }
    EXPECT_EQ(voxel.cover, (std::array<float, 6>{1, 1, 1, 1, 1, 1}));
  }
}

TEST(VoxelServer, GathersHemispheres) { expect_sky_over_ground(true); }
TEST(VoxelServer, LeavesOutWhatNoSurfaceFaces) { expect_sky_over_ground(false); }

/// What is left out is not looked up either: away from other walls nothing changes.
TEST(VoxelServer, PicturesTakeNothingFromWhatIsLeftOut) {
  const ddgi::Scene scene = ddgi::test::room({2, 1.5F, 3}, 0.5F, 0.2F);
  const auto options = [&](const char* which) {
    return few(scene, {"size=0.9", "warmup=0", "form=halves", which});
  };
  VoxelServer all(scene, options("all-directions=1"), 2, {});
  VoxelServer faced(scene, options("all-directions=0"), 2, {});
  all.update(0);
  faced.update(0);
  EXPECT_LT(faced.rays(), all.rays());
  ddgi::Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Vec3 place{random.in(-0.5F, 0.5F), 1.5F, random.in(-1.5F, 1.5F)};
    EXPECT_EQ(faced.field().irradiance(place, {0, -1, 0}, 0),
              all.field().irradiance(place, {0, -1, 0}, 0));
  }
}

TEST(VoxelServer, IsTheSameForAnyNumberOfThreadsAndAgain) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  for (const Given& given :
       {Given{}, Given{"form=halves", "rays-turned=1", "brick=8"}, Given{"rays-anew=1"}}) {
    const VoxelOptions options = few(scene, given);
    const auto textures = traced(scene, options, 1, {0, 1, 1.5});
    EXPECT_EQ(textures, traced(scene, options, 1, {0, 1, 1.5}));
    EXPECT_EQ(textures, traced(scene, options, 4, {0, 1, 1.5}));
  }
}

TEST(VoxelServer, FollowsWhatMovesTheSeedAndTheRays) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  const VoxelOptions options = few(scene);
  const auto at = [&](const VoxelOptions& with, double time) {
    return traced(scene, with, 2, {time});
  };
  const auto usual = at(options, 0);
  EXPECT_NE(usual.first, at(options, 3).first) << "voxels of the ball";
  EXPECT_NE(usual.second, at(options, 3).second);
  VoxelOptions other = options;
  other.gather.seed = 2;
  EXPECT_EQ(usual.first, at(other, 0).first);
  EXPECT_NE(usual.second, at(other, 0).second);
  EXPECT_NE(usual.second, at(few(scene, {"rays-turned=1"}), 0).second);
}

TEST(VoxelServer, RaysAnewMakeNoise) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  const auto twice = [&](const Given& more) {
    Given given{"size=3", "rays=3", "warmup=60"};
    given.insert(given.end(), more.begin(), more.end());
    const VoxelOptions options = few(scene, given);
    return traced(scene, options, 2, {0}) == traced(scene, options, 2, {0, 0});
  };
  EXPECT_TRUE(twice({}));
  EXPECT_TRUE(twice({"rays-turned=1"}));
  EXPECT_FALSE(twice({"rays-anew=1"}));
}

TEST(VoxelSource, GivesFramesOfItsVolume) {
  for (const char* brick : {"brick=4", "brick=8"}) {
    kinds::TraceRequest request;
    request.scene = ddgi::test::busy_room();
    request.settings = settings({"size=1.5", "rays=2", "warmup=0", "form=halves", brick});
    const kinds::Feed feed = kTracedVoxels.trace(std::move(request));
    ASSERT_EQ(feed.volumes.size(), 1U);
    const kinds::FeedVolume& volume = feed.volumes[0];
    EXPECT_EQ(validate(volume.desc), Status::ok);
    EXPECT_EQ(volume.geometry.spacing, (Position{1.5F, 1.5F, 1.5F}));
    EXPECT_EQ(validate(volume.geometry), Status::ok);
    ASSERT_EQ(feed.remarks.size(), 1U);
    EXPECT_NE(feed.remarks[0].find(" of 1.5 m in "), std::string::npos) << feed.remarks[0];
    EXPECT_NE(feed.remarks[0].find(" of 3 m in "), std::string::npos);
    const auto textures = textures_of(volume.desc);
    for (const double time : {0.0, 1.0}) {
      const kinds::FeedFrame frame = feed.next({time, {}});
      EXPECT_TRUE(frame.remarks.empty());
      ASSERT_EQ(frame.volumes[0].textures.size(), 2U);
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(frame.volumes[0].textures[i].size(), texture_bytes(textures[i]->desc));
      }
    }
  }
}

TEST(VoxelSource, SaysWhatIsLeftOut) {
  kinds::TraceRequest request;
  request.scene = ddgi::test::busy_room();
  request.settings = settings({"size=1.5", "rays=2", "warmup=0", "bricks=9"});
  const kinds::Feed feed = kTracedVoxels.trace(std::move(request));
  const auto remarks = feed.next({0, {}}).remarks;
  ASSERT_EQ(remarks.size(), 1U);
  const std::size_t at = remarks[0].find("--set bricks=");
  ASSERT_NE(at, std::string::npos) << remarks[0];
  EXPECT_TRUE(feed.next({0, {}}).remarks.empty()) << "said once";
  // Its advice is enough.
  const std::string advice = remarks[0].substr(at + 6, remarks[0].find(' ', at + 6) - at - 6);
  kinds::TraceRequest again;
  again.scene = ddgi::test::busy_room();
  again.settings = settings({"size=1.5", "rays=2", "warmup=0", advice});
  EXPECT_TRUE(kTracedVoxels.trace(std::move(again)).next({0, {}}).remarks.empty());
}

TEST(VoxelSettings, SayWhatIsTraced) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  const VoxelOptions usual = options_of(settings({}), scene, 7);
  EXPECT_EQ(usual.size, 0.5F);
  EXPECT_EQ(usual.shape.side, 4U);
  EXPECT_EQ(usual.form, VoxelForm::shared_exponent);
  EXPECT_EQ(usual.slots, 0U);
  EXPECT_EQ(usual.gather.rays, 16U);
  EXPECT_EQ(usual.gather.warmup, 3U);
  EXPECT_EQ(usual.gather.seed, 7U);
  EXPECT_FALSE(usual.gather.turned || usual.gather.anew || usual.all_directions);
  EXPECT_EQ(usual.box.lo, scene.volume.lo - (Vec3{1, 1, 1}));
  const VoxelOptions options =
      options_of(settings({"size=2", "brick=8", "form=halves", "bricks=77"}), scene, 1);
  EXPECT_EQ(options.size, 2.0F);
  EXPECT_EQ(options.shape.side, 8U);
  EXPECT_EQ(options.form, VoxelForm::halves);
  EXPECT_EQ(options.slots, 77U);
}

TEST(VoxelSettings, RefuseWhatMakesNoSense) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  for (const char* text :
       {"size=", "size=0", "size=0.001", "size=101", "size=nan", "brick=2", "brick=16",
        "form=float", "bricks=-1", "bricks=16777217", "rays=0", "rays=4097", "all-directions=2",
        "rays-turned=2", "rays-anew=yes", "warmup=101"}) {
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

}  // namespace
}  // namespace gicodec::voxels
