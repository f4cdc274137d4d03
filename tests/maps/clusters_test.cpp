#include "dump/error.h"
#include "halves.h"
#include "maps/blend_slots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace gicodec::maps {
namespace {

struct Clustered {
  ddgi::Scene scene = test::halves();
  ddgi::ThreadPool pool;
  ddgi::RayScene rays;
  Parameterisation map;
  std::vector<MapTexel> texels;
  Bases bases;

  explicit Clustered(unsigned threads, std::uint32_t target, float spacing = 0)
      : pool(threads), rays(scene), map(scene, 96, 96) {
    ddgi::FrameState rest;
    for (const ddgi::Object& object : scene.objects) rest.transforms.push_back(object.transform);
    rest.emission.resize(scene.materials.size());
    rays.set_state(rest);
    texels = open_texels(map, rays, pool);
    bases = make_bases(map, rays, texels, target, spacing, pool);
  }
};

TEST(Clusters, EveryTexelHasUpToEightBasesOfWeight255) {
  const Clustered c(2, 250);
  ASSERT_EQ(c.bases.blends.size(), c.texels.size());
  for (const Blend& blend : c.bases.blends) {
    std::uint32_t sum = 0;
    for (std::size_t k = 0; k < kMapBlends; ++k) {
      sum += blend.weight[k];
      EXPECT_LT(blend.basis[k], c.bases.centres.size());
      for (std::size_t other = 0; other < k; ++other) {
        EXPECT_FALSE(blend.weight[k] != 0 && blend.weight[other] != 0 &&
                     blend.basis[k] == blend.basis[other]);
      }
    }
    EXPECT_EQ(sum, 255U);
  }
}

TEST(Clusters, SlotsFollowTheTexelToTheLeft) {
  const Clustered c(2, 250);
  const auto weights = [](const Blend& blend) {
    std::map<std::uint16_t, std::uint8_t> of_bases;
    for (std::size_t k = 0; k < kMapBlends; ++k) {
      if (blend.weight[k] != 0) of_bases[blend.basis[k]] = blend.weight[k];
    }
    return of_bases;
  };
  std::vector<Blend> blends = c.bases.blends;
  for (Blend& blend : blends) {
    std::ranges::reverse(blend.basis);
    std::ranges::reverse(blend.weight);
  }
  align_slots(c.texels, c.map.width(), blends);
  std::size_t shared = 0;
  for (std::size_t i = 0; i < blends.size(); ++i) {
    ASSERT_EQ(weights(blends[i]), weights(c.bases.blends[i]));
    const std::uint32_t place = c.texels[i].place;
    if (i == 0 || place % c.map.width() == 0 || c.texels[i - 1].place + 1 != place) continue;
    const Blend &left = blends[i - 1], &own = blends[i];
    const auto named = weights(own);
    for (std::size_t k = 0; k < kMapBlends; ++k) {
      if (left.weight[k] == 0 || !named.contains(left.basis[k])) continue;
      EXPECT_EQ(own.basis[k], left.basis[k]);
      EXPECT_NE(own.weight[k], 0);
      ++shared;
    }
  }
  EXPECT_GT(shared, 0U);
}

TEST(Clusters, BasesAreNearAndLookIntoLikeDirections) {
  const Clustered c(2, 0, 1.5F);
  for (std::size_t i = 0; i < c.texels.size(); ++i) {
    const MapPoint at = point_of(c.map, c.rays, c.texels[i]);
    const Blend& blend = c.bases.blends[i];
    for (std::size_t k = 0; k < kMapBlends; ++k) {
      if (blend.weight[k] == 0) continue;
      const MapPoint basis = point_of(c.map, c.rays, c.bases.centres[blend.basis[k]]);
      EXPECT_GE(dot(at.normal, basis.normal), kLikeBasis - 1e-5F);
      const float density =
          c.map.scene().charts[c.map.scene().chart_of[c.texels[i].triangle]].density;
      EXPECT_LE(length(basis.position - at.position), 2 * 1.5F / density + 1e-4F);
    }
  }
}

TEST(Clusters, TexelsShareNothingThroughAWall) {
  const Clustered c(2, 0, 2.5F);  // radii reach through the wall, along floor and ceiling
  std::size_t shared = 0, ball = 0;
  for (std::size_t i = 0; i < c.texels.size(); ++i) {
    const Vec3 at = point_of(c.map, c.rays, c.texels[i]).position;
    const bool own = c.map.instance_of(c.texels[i].triangle).object == 1;
    for (std::size_t k = 0; k < kMapBlends; ++k) {
      if (c.bases.blends[i].weight[k] == 0) continue;
      const MapTexel& basis = c.bases.centres[c.bases.blends[i].basis[k]];
      const Vec3 from = point_of(c.map, c.rays, basis).position;
      const bool other_side = (at.x < -0.3F && from.x > 0.3F) || (at.x > 0.3F && from.x < -0.3F);
      shared += other_side ? 1 : 0;
      ball += own != (c.map.instance_of(basis.triangle).object == 1) ? 1 : 0;
    }
  }
  EXPECT_EQ(shared, 0U);
  EXPECT_EQ(ball, 0U) << "what moves shares nothing with what does not";
}

TEST(Clusters, TexelsWithinSolidsAreLeftOut) {
  const Clustered c(2, 100);
  EXPECT_LT(c.texels.size(), c.map.texels().size());
  for (const MapTexel& texel : c.texels) {
    const MapPoint at = point_of(c.map, c.rays, texel);
    // The wall stands on the floor and goes through it.
    const bool within = std::abs(at.position.x) < 0.1F && std::abs(at.position.y) > 2.95F &&
                        std::abs(at.geometric_normal.y) > 0.9F && std::abs(at.position.z) < 3 &&
                        std::abs(at.position.y) < 3.05F;
    EXPECT_FALSE(within) << at.position.x << " " << at.position.y << " " << at.position.z;
  }
}

TEST(Clusters, AreTheSameForAnyNumberOfThreads) {
  const Clustered one(1, 200), two(2, 200), five(5, 200);
  for (const Clustered* other : {&two, &five}) {
    EXPECT_EQ(blends_of(one.map, one.texels, one.bases.blends),
              blends_of(other->map, other->texels, other->bases.blends));
    EXPECT_EQ(one.bases.rays, other->bases.rays);
  }
}

TEST(Clusters, ComeNearTheNumberThatIsAskedFor) {
  const Clustered c(2, 400);
  EXPECT_GT(c.bases.centres.size(), 300U);
  EXPECT_LT(c.bases.centres.size(), 500U);
}

}  // namespace
}  // namespace gicodec::maps
