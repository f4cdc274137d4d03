// The server: what changes, what stays, the same whatever the number of threads.
#include "ao/ao.h"
#include "ao/point_server.h"
#include "ao/twisting.h"
#include "dump/error.h"
#include "rolling_room.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <memory>
#include <set>

namespace gicodec::ao {
namespace {

using Textures = std::vector<std::vector<std::byte>>;

ServerOptions few_points() {
  ServerOptions options;
  options.generation.points = 16;
  options.rays = 16;
  options.threshold = 0;
  return options;
}

/// The scene at some times, one update for each.
Textures updated(const ddgi::Scene& scene, const ServerOptions& options, unsigned threads,
                 std::initializer_list<double> times) {
  ddgi::ThreadPool pool(threads);
  ddgi::RayScene rays(scene);
  PointServer server(scene, options, pool);
  for (const double time : times) {
    rays.set_state(scene.state_at(time));
    server.update(rays);
  }
  return server.textures();
}

TEST(PointServer, IsTheSameForAnyNumberOfThreads) {
  const ddgi::Scene scene = test::rolling_room();
  for (const bool anew : {false, true}) {
    ServerOptions options = few_points();
    options.rays_anew = anew;
    const Textures textures = updated(scene, options, 1, {0, 1, 1.5});
    EXPECT_EQ(textures, updated(scene, options, 2, {0, 1, 1.5}));
    EXPECT_EQ(textures, updated(scene, options, 5, {0, 1, 1.5}));
  }
}

TEST(PointServer, TracesAllThatMayHaveChanged) {
  // Who was there from the beginning has what somebody has who comes late and traces everything.
  const ddgi::Scene scene = test::rolling_room();
  const Textures late = updated(scene, few_points(), 2, {3.5});
  EXPECT_EQ(updated(scene, few_points(), 2, {0, 1, 3.25, 3.5}), late);
  EXPECT_NE(updated(scene, few_points(), 2, {0})[0], late[0]);
}

TEST(PointServer, RigidMotionChangesNothingButOcclusion) {
  const ddgi::Scene scene = test::rolling_room();
  const Textures before = updated(scene, few_points(), 2, {0});
  const Textures after = updated(scene, few_points(), 2, {0, 2.5});
  ASSERT_EQ(before[0].size(), after[0].size());
  std::size_t changed = 0;
  for (std::size_t at = 0; at < before[0].size(); at += 4) {
    EXPECT_EQ(std::memcmp(&before[0][at], &after[0][at], 3), 0);
    changed += before[0][at + 3] != after[0][at + 3];
  }
  EXPECT_GT(changed, 0U);
  EXPECT_EQ(before[1], after[1]);
  EXPECT_EQ(before[2], after[2]);
  EXPECT_NE(before[3], after[3]);
}

TEST(PointServer, SendsNoChangeUpToTheThreshold) {
  const ddgi::Scene scene = test::rolling_room();
  ServerOptions options = few_points();
  options.threshold = 255;
  EXPECT_EQ(updated(scene, options, 2, {0, 2.5})[0], updated(scene, options, 2, {0})[0]);
  options.threshold = 40;
  const Textures coarse = updated(scene, options, 2, {0, 2.5});
  const Textures fine = updated(scene, few_points(), 2, {0, 2.5});
  const Textures before = updated(scene, options, 2, {0});
  for (std::size_t at = 3; at < fine[0].size(); at += 4) {
    const auto value = [at](const Textures& t) { return std::to_integer<int>(t[0][at]); };
    const bool far = std::abs(value(fine) - value(before)) > 40;
    EXPECT_EQ(value(coarse), far ? value(fine) : value(before));
  }
}

TEST(PointServer, RaysAnewMakeNoise) {
  const ddgi::Scene scene = test::rolling_room();
  ServerOptions options = few_points();
  EXPECT_EQ(updated(scene, options, 2, {1, 1})[0], updated(scene, options, 2, {1})[0]);
  options.rays_anew = true;
  EXPECT_NE(updated(scene, options, 2, {1, 1})[0], updated(scene, options, 2, {1})[0]);
}

TEST(PointServer, PassesOverWhatNobodySeesUntilSomebodyDoes) {
  const ddgi::Scene scene = test::rolling_room();
  ddgi::ThreadPool pool(2);
  ddgi::RayScene rays(scene);
  PointServer server(scene, few_points(), pool);
  rays.set_state(scene.state_at(0));
  server.update(rays);
  const Textures before = server.textures();
  // The ball is at z = 3; the camera looks at the other end.
  constexpr float kAspect = 16.0F / 9;
  const ExtendedView away({.eye = {0, 0, -1}, .target = {0, 0, -8}}, kAspect, 5);
  rays.set_state(scene.state_at(2.5));
  server.update(rays, std::array{away});
  EXPECT_EQ(server.textures()[0], before[0]);
  EXPECT_GT(server.statistics().unseen, 0U);
  const ExtendedView toward({.eye = {0, 0, -7}, .target = {0, 0, 8}}, kAspect, 60);
  server.update(rays, std::array{away, toward});
  EXPECT_NE(server.textures()[0], before[0]);
  server.update(rays);
  EXPECT_EQ(server.textures(), updated(scene, few_points(), 2, {2.5}));
}

TEST(ExtendedView, ContainsWhatTheCameraSeesAndSomeMore) {
  const auto with_margin = [](float margin) {
    return ExtendedView({.eye = {0, 0, 0}, .target = {0, 0, -1}, .fov_y = 60}, 1, margin);
  };
  const ExtendedView view = with_margin(15);
  const auto at = [](float degrees) {
    return ddgi::Vec3{0, std::sin(ddgi::radians(degrees)), -std::cos(ddgi::radians(degrees))} * 7;
  };
  EXPECT_TRUE(view.contains(at(0)));
  EXPECT_TRUE(view.contains(at(53)));
  EXPECT_TRUE(view.contains(at(-53)));
  EXPECT_FALSE(view.contains(at(56)));
  EXPECT_FALSE(view.contains(at(180)));
  EXPECT_TRUE(view.contains({3, 0, -4}));  // In a corner's direction.
  EXPECT_TRUE(with_margin(130).contains(at(159)));
  EXPECT_TRUE(with_margin(180).contains(at(180)));
}

TEST(PointServer, FollowsPointsThatMoveWithinTheirInstance) {
  ddgi::Scene rest = ddgi::test::room({6, 3, 8}, 0.6F, 0);
  const TwistingColumn column(rest, {0, -3, 0});
  ServerOptions options = few_points();
  options.generation.margin = TwistingColumn::kMargin;
  options.spare_cells = 0.5;
  ddgi::ThreadPool pool(2);
  PointServer server(rest, options, pool);
  std::size_t instance = 0;
  while (server.generated().instances[instance].object != column.object()) ++instance;
  const auto at_rest = server.generated().instances[instance].points;

  Textures client;
  for (int frame = 0; frame < 6; ++frame) {
    const double time = 0.5 * frame;
    const ddgi::Scene scene = column.at(rest, time);
    const ddgi::RayScene rays(scene);
    TwistingColumn::move(time, at_rest, server.move(instance));
    server.update(rays);
    client = server.textures();
    // Every point is found where it is now.
    const AoGrid& grid = server.memory().grids()[instance];
    const auto cells = static_cast<std::uint32_t>(server.memory().cells().size());
    std::size_t found = 0;
    for (const SurfacePoint& point : server.generated().instances[instance].points) {
      const auto place = place_in(grid, point.position);
      ASSERT_TRUE(place);
      const auto slot = find_ao_cell(grid, place->cell, client[1], cells);
      if (!slot) continue;
      const AoPoint expected{place->within, {point.normal.x, point.normal.y, point.normal.z}, 0};
      for (std::size_t i = 0; i < kAoCellPoints; ++i) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &client[0][(*slot * kAoCellPoints + i) * 4], sizeof bits);
        if (with_visible(bits, 0) != pack_ao_point(expected)) continue;
        ++found;
        break;
      }
    }
    const std::uint64_t lost = server.memory().statistics().overflow();
    EXPECT_GE(found + lost, at_rest.size());
    EXPECT_LT(lost, at_rest.size() / 10);
    EXPECT_LE(server.memory().statistics().cells, cells);
  }
}

kinds::Settings settings(std::vector<std::string> given) {
  return {kTracedAoPoints.name, kTracedAoPoints.settings, given};
}

TEST(AoSource, RefusesSettingsThatMakeNoSense) {
  EXPECT_THROW(settings({"metres=4"}), tools::Error);
  for (const char* text : {"points=0", "points=a", "rays=0", "rays-anew=2", "threshold=256",
                           "distance=0", "max-points=0", "view-margin=181", "outside=yes"}) {
    EXPECT_THROW(kTracedAoPoints.trace({test::rolling_room(), settings({text})}), tools::Error)
        << text;
  }
}

TEST(AoSource, OfASceneWithoutSurfacesIsRefused) {
  EXPECT_THROW(kTracedAoPoints.trace({ddgi::Scene{}, settings({})}), tools::Error);
}

TEST(AoSource, GivesFramesOfItsVolumeAndSaysWhatIsLess) {
  const auto trace = [](unsigned threads) {
    return kTracedAoPoints.trace(
        {test::rolling_room(), settings({"max-points=500", "rays=8"}), 1, threads});
  };
  const kinds::Feed feed = trace(1), other = trace(3);
  ASSERT_EQ(feed.volumes.size(), 1U);
  EXPECT_FALSE(feed.remarks.empty());
  EXPECT_NE(feed.remarks.front().find("max-points"), std::string::npos);
  const VolumeDesc& volume = feed.volumes.front().desc;
  EXPECT_EQ(validate(volume), Status::ok);
  EXPECT_EQ(validate(feed.volumes.front().geometry), Status::ok);
  for (const double time : {0.0, 1.0}) {
    const kinds::FeedFrame frame = feed.next({time, {Viewpoint{}}});
    const auto& textures = frame.volumes.at(0).textures;
    const auto named = textures_of(feed.volumes.front().desc);
    ASSERT_EQ(textures.size(), named.size());
    for (std::size_t i = 0; i < named.size(); ++i) {
      EXPECT_EQ(textures[i].size(), texture_bytes(named[i]->desc));
    }
    EXPECT_EQ(textures, other.next({time, {}}).volumes.at(0).textures);
  }
}

TEST(AoSource, UpdatesAllForThoseWhoDoNotTellWhereTheyLook) {
  // The ball rolls behind the viewer.
  const Viewpoint away{.eye = {0, 0, -1}, .target = {0, 0, -8}};
  const auto after = [](const kinds::FeedRequest& request) {
    const kinds::Feed feed = kTracedAoPoints.trace(
        {test::rolling_room(), settings({"points=8", "rays=8", "view-margin=5"})});
    static_cast<void>(feed.next({0, {}}));
    return feed.next(request).volumes.at(0).textures;
  };
  const auto all = after({2.5, {}});
  EXPECT_NE(after({2.5, {away}}), all);
  EXPECT_EQ(after({2.5, {away}, true}), all);
}

}  // namespace
}  // namespace gicodec::ao
