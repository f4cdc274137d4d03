// What clients say of where they look may be any numbers.
#include "stream/views.h"

#include "ddgi/scenes.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace gicodec::streaming {
namespace {

using ddgi::Vec3;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kMax = std::numeric_limits<float>::max();

/// Numbers of all magnitudes, those that end ranges, and those of cameras.
float any_number(std::mt19937& random) {
  constexpr std::array<float, 14> kSpecial{0.0F,  -0.0F, 1e-45F, 1e-38F, 1e15F, 1.8e18F, 1e19F,
                                           3e38F, kMax,  -kMax,  1.0F,   2.5F,  kNaN,    kInfinity};
  switch (random() % 3) {
    case 0:
      return std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    case 1:
      return kSpecial[random() % kSpecial.size()];
    default:
      return std::uniform_real_distribution<float>(-4, 4)(random);
  }
}

TEST(Views, TakeAnyNumbersAndSeeTheSameOfOtherViewers) {
  Views views(ddgi::make_tomb(), 64, 1);
  ViewRequest request;
  request.volumes.push_back({{{6, 4, 6}, {-3, 0, -3}, {1, 1, 1}, {}}});
  const Viewpoint honest{{0, 1, 1}, {0, 1, 0}};
  request.viewers = {{1, honest}};
  const auto alone = views.look(request).seen;
  ASSERT_EQ(alone.size(), 1U);
  ASSERT_NE(std::ranges::count(alone[0].volumes[0], 1), 0);
  std::mt19937 random(5);
  const auto number = [&] { return any_number(random); };
  for (int i = 0; i < 500; ++i) {
    Viewpoint other{{number(), number(), number()},
                    {number(), number(), number()},
                    {number(), number(), number()}};
    if (i % 3 == 0) other.eye = honest.eye;
    if (i % 2 == 0) other.fov_y = number(), other.aspect = number(), other.time = number();
    request.viewers = {{2, other}, {1, honest}};
    const auto seen = views.look(request).seen;
    ASSERT_EQ(seen.size(), 2U);
    EXPECT_EQ(seen[1].volumes, alone[0].volumes);
  }
  // The scene at times that no clock shows.
  request.viewers = {{1, honest}};
  for (const double time : {1e300, -1e300, std::numeric_limits<double>::max()}) {
    request.time = time;
    EXPECT_EQ(views.look(request).seen.size(), 1U);
  }
}

TEST(Views, LookAlongDirectionsOfAnyLength) {
  Views views(ddgi::make_tomb(), 64, 1);
  ViewRequest request;
  request.volumes.push_back({{{6, 4, 6}, {-3, 0, -3}, {1, 1, 1}, {}}});
  const auto seen = [&](const Viewpoint& view) {
    request.viewers = {{1, view}};
    return views.look(request).seen[0].volumes[0];
  };
  const BlockMask usual = seen({{0, 1, 1}, {0, 1, 0}, {0, 1, 0}});
  ASSERT_NE(std::ranges::count(usual, 1), 0);
  EXPECT_EQ(seen({{0, 1, 1}, {0, 1, -3e38F}, {0, 3e38F, 0}}), usual);
  EXPECT_EQ(seen({{0, 1, 1}, {0, 1, 0}, {0, 1e-38F, 0}}), usual);
}

TEST(RayScene, RaysOfNumbersThatNoSceneHasMeetNothing) {
  const ddgi::Scene scene = ddgi::make_tomb();
  const ddgi::RayScene rays(scene);
  const Vec3 inside{0, 1, 1}, ahead{0, 0, -1};
  EXPECT_TRUE(rays.intersect(inside, ahead, 0));
  for (const float bad : {kNaN, kInfinity, -kInfinity, kMax, -kMax, 3e38F, 1e19F}) {
    for (const Vec3 v : {Vec3{bad, 0, 0}, Vec3{0, bad, 0}, Vec3{0, 0, bad}, Vec3{bad, bad, bad}}) {
      EXPECT_FALSE(rays.intersect(v, ahead, 0));
      EXPECT_FALSE(rays.intersect(inside, v, 0));
      EXPECT_FALSE(rays.behind_static_surface(v, ahead));
      EXPECT_FALSE(rays.behind_static_surface(inside, v));
      EXPECT_FALSE(rays.occluded(v, ahead, 10));
      EXPECT_FALSE(rays.occluded(inside, v, 10));
    }
  }
}

}  // namespace
}  // namespace gicodec::streaming
