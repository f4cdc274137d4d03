#include "dump/error.h"
#include "halves.h"

#include <gicodec/irradiance_vectors.h>

#include <gtest/gtest.h>

#include <random>

namespace gicodec::maps {
namespace {

using test::halves;
using test::Held;

/// Server and client of the same scene.
struct Pair {
  ddgi::Scene scene = halves();
  MapServer server;
  ddgi::RayScene rays;
  Held held;
  MapLight light;

  explicit Pair(const std::vector<std::string>& settings)
      : server(scene, test::options(settings), 2, {}),
        rays(scene),
        held((server.update(0), server)),
        light(rays, held.desc) {
    rays.set_state(scene.state_at(0));
  }
};

TEST(MapLight, ReconstructsTheServersMapFromBases) {
  for (const char* format : {"format=E5B9G9R9_UFLOAT_PACK32", "format=A2B10G10R10_UNORM_PACK32",
                             "format=B10G11R11_UFLOAT_PACK32", "format=R16G16B16A16_SFLOAT"}) {
    Pair pair({"way=bases", format});
    pair.held.show(pair.light, 0);
    for (const MapTexel& texel : pair.server.texels()) {
      ASSERT_EQ(pair.light.values()[texel.place], pair.server.values()[texel.place]) << format;
    }
  }
}

TEST(MapLight, BothWaysGiveTheSameLight) {
  Pair bases({"way=bases"}), map({"way=map", "gather=bases"});
  bases.held.show(bases.light, 0);
  map.held.show(map.light, 0);
  for (const MapTexel& texel : bases.server.texels()) {
    const Vec3 a = bases.light.values()[texel.place], b = map.light.values()[texel.place];
    const float most = std::max({a.x, a.y, a.z});
    // A shared exponent has nine bits below the largest channel.
    ASSERT_NEAR(a.x, b.x, most / 256 + 1e-6F);
    ASSERT_NEAR(a.y, b.y, most / 256 + 1e-6F);
    ASSERT_NEAR(a.z, b.z, most / 256 + 1e-6F);
  }
}

TEST(MapLight, IsWhatTheSurfacesTexelHolds) {
  Pair pair({"way=map", "gather=texels", "format=R16G16B16A16_SFLOAT"});
  pair.held.show(pair.light, 0);
  const auto hit = pair.rays.intersect({3, 2.5F, 2}, {0, -1, 0}, 0);
  ASSERT_TRUE(hit.has_value());
  const Vec3 seen = pair.light.irradiance({*hit, {0, 1, 0}});
  const Parameterisation::Taps taps = pair.server.map().taps(*hit);
  Vec3 lo{1e9F, 1e9F, 1e9F}, hi{};
  for (std::size_t i = 0; i < 4; ++i) {
    if (taps.weight[i] <= 0) continue;
    lo = min(lo, pair.server.values()[taps.place[i]]);
    hi = max(hi, pair.server.values()[taps.place[i]]);
  }
  EXPECT_GT(seen.x, 0.01F);
  EXPECT_GE(seen.x, lo.x * 0.999F);
  EXPECT_LE(seen.x, hi.x * 1.001F);
}

TEST(MapLight, ComesNearerToWhatIsReceivedWithTime) {
  Pair pair({"way=map", "gather=texels", "format=R16G16B16A16_SFLOAT"});
  pair.held.show(pair.light, 0);
  const std::vector<Vec3> first(pair.light.values().begin(), pair.light.values().end());
  pair.server.update(3);
  const Held later(pair.server);
  later.show(pair.light, MapLight::kFilter);
  MapLight unfiltered(pair.rays, later.desc);
  later.show(unfiltered, 0);
  const float share = 1 - std::exp(-1.0F);
  std::size_t moved = 0;
  for (const MapTexel& texel : pair.server.texels()) {
    const Vec3 from = first[texel.place], to = unfiltered.values()[texel.place];
    ASSERT_NEAR(pair.light.values()[texel.place].x, from.x + (to.x - from.x) * share, 1e-5F);
    moved += from == to ? 0 : 1;
  }
  EXPECT_GT(moved, pair.server.texels().size() / 4);
}

TEST(MapLight, TakesAnyTexelsAndStaysFinite) {
  std::mt19937 random(7);
  for (const std::vector<std::string>& way :
       {std::vector<std::string>{"way=bases", "format=R16G16B16A16_SFLOAT"},
        {"way=bases", "format=B10G11R11_UFLOAT_PACK32"},
        {"way=map", "format=E5B9G9R9_UFLOAT_PACK32"},
        {"way=map", "format=R16G16B16A16_SFLOAT"}}) {
    Pair pair(way);
    Held hostile = pair.held;
    for (int round = 0; round < 8; ++round) {
      for (std::size_t t = 0; t + 1 < hostile.texels.size(); ++t) {
        for (std::byte& byte : hostile.texels[t]) {
          byte = round == 0 ? std::byte{0xFF} : static_cast<std::byte>(random());
        }
      }
      hostile.show(pair.light, round);
      for (const Vec3 value : pair.light.values()) {
        ASSERT_TRUE(std::isfinite(value.x + value.y + value.z));
        ASSERT_GE(std::min({value.x, value.y, value.z}), 0);
      }
    }
  }
}

TEST(MapLight, RefusesAnotherParameterisation) {
  Pair pair({"way=bases"});
  Held other = pair.held;
  other.texels.back()[0] ^= std::byte{1};
  EXPECT_THROW(other.show(pair.light, 0), tools::Error);
  other.forget_all();  // it was not told yet
  EXPECT_NO_THROW(other.show(pair.light, 0));
}

TEST(MapLight, RefusesTexturesThatStandOtherwise) {
  Pair pair({"way=bases"});
  Held other = pair.held;
  other.desc.groups[1].textures[1].desc.layout = Tiling::atlas_xy_z;
  EXPECT_THROW(other.show(pair.light, 0), tools::Error);
  other = pair.held;
  other.texels[2].resize(24);
  EXPECT_THROW(other.show(pair.light, 0), tools::Error);
}

TEST(MapLight, RefusesVolumesThatCannotBeDrawn) {
  const ddgi::Scene scene = halves();
  const ddgi::RayScene rays(scene);
  const auto refused = [&](const VolumeDesc& volume) {
    try {
      const MapLight light(rays, volume);
    } catch (const tools::Error& error) {
      return error.code() == tools::Exit::bad_input;
    }
    return false;
  };
  EXPECT_TRUE(refused(*irradiance_vector_volume({2, 2, 2})));
  EXPECT_TRUE(refused(*irradiance_map_volume({.width = kMaxMapSide, .height = 1})));
  EXPECT_TRUE(refused(*irradiance_map_volume({.width = 2, .height = 2}))) << "too small";
}

TEST(MapLight, NothingReceivedIsDark) {
  Pair pair({"way=map"});
  Held nothing = pair.held;
  for (auto& texels : nothing.texels) std::fill(texels.begin(), texels.end(), std::byte{});
  nothing.forget_all();
  nothing.show(pair.light, 0);
  for (const Vec3 value : pair.light.values()) ASSERT_EQ(value, Vec3{});
}

}  // namespace
}  // namespace gicodec::maps
