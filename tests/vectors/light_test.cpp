// The client's light, whatever it was sent and in whatever order.
#include "dump/error.h"
#include "fields.h"
#include "scenes.h"
#include "support.h"

#include <gicodec/gicodec.h>
#include <gicodec/photons.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace gicodec::vectors {
namespace {

constexpr std::array kFills{Fill::none, Fill::push_pull, Fill::smooth};
constexpr std::array kInterpolations{Interpolation::trilinear, Interpolation::tricubic};

/// A room with a solid block in it, of which some vertices are within.
test::Held served(bool floats) {
  static const ddgi::Scene scene = ddgi::test::busy_room();
  VectorOptions options;
  options.grid = {7, 4, 9};
  options.box = scene.volume;
  options.gather.rays = 32;
  options.floats = floats;
  VectorServer server(scene, options, 2, {});
  server.update(1);
  return test::Held(server);
}

bool is_sound(Vec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) &&
         std::min({v.x, v.y, v.z}) >= 0;
}

TEST(VectorLight, IsTheFieldOfItsRecords) {
  for (const bool floats : {false, true}) {
    const test::Held held = served(floats);
    VectorLight light(held.desc, {Interpolation::tricubic, Fill::none});
    held.show(light);
    const VectorCode code(floats);
    std::size_t known = 0;
    for (std::size_t i = 0; i < light.field().vertices.size(); ++i) {
      for (std::size_t h = 0; h < kHemispheres; ++h) {
        const auto expected = code.load(&held.texels[(kHemispheres * i + h) * code.bytes()]);
        EXPECT_EQ(light.field().vertices[i][h], expected.vectors());
      }
      known += light.field().known[i];
    }
    EXPECT_GT(known, light.field().known.size() / 2);
    EXPECT_LT(known, light.field().known.size());  // Some are within the block.
    EXPECT_EQ(light.field().geometry, held.geometry);
    ddgi::Surface surface;
    surface.position = {1, 0.3F, 2};
    surface.normal = normalize(Vec3{1, 2, -1});
    EXPECT_EQ(light.irradiance({surface, {}, 0, 0}),
              light.field().irradiance(surface.position, surface.normal, Interpolation::tricubic));
  }
}

/// Blocks of a volume that has scrolled light the places where they stand.
TEST(VectorLight, FollowsItsVolume) {
  test::Held held = served(true);
  held.geometry.scroll = {2, -1, 13};
  VectorLight light(held.desc, {Interpolation::trilinear, Fill::none});
  held.show(light);
  const VectorCode code(true);
  std::size_t compared = 0;
  for (std::uint32_t block = 0; block < block_count(held.texture()); ++block) {
    const auto at = block_position(held.geometry, block);
    const auto stored = code.load(&held.texels[kHemispheres * block * code.bytes()]);
    if (stored.direction == Vec3{}) continue;  // Those around it are seen instead.
    ++compared;
    const Vec3 lit =
        light.field().irradiance({at[0], at[1], at[2]}, {1, 0, 0}, Interpolation::trilinear);
    const Vec3 expected = max(stored.vectors().along({1, 0, 0}), {});
    EXPECT_LT(length(lit - expected), 1e-3F * (1 + length(expected))) << block;
  }
  EXPECT_GT(compared, block_count(held.texture()) / 2);
}

TEST(VectorLight, QuantisedIsNearFloats) {
  const test::Held quantised = served(false), floats = served(true);
  VectorLight one(quantised.desc), other(floats.desc);
  quantised.show(one);
  floats.show(other);
  const auto a = test::picture(one), b = test::picture(other);
  float largest = 0, error = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, length(b[i]));
    error = std::max(error, length(a[i] - b[i]));
  }
  EXPECT_GT(error, 0);
  EXPECT_LT(error, 0.02F * largest);
}

/// Bundles of vertices in any order, as packets: the same grid in the end, and the same picture.
TEST(VectorLight, TheOrderInWhichVerticesComeDoesNotMatter) {
  for (const bool floats : {false, true}) {
    const test::Held held = served(floats);
    const TextureDesc& desc = held.texture();
    const std::size_t block = block_bytes(desc);
    std::vector<std::vector<Vec3>> pictures;
    for (std::uint32_t seed = 0; seed < 3; ++seed) {
      std::vector<std::uint32_t> order(block_count(desc));
      std::iota(order.begin(), order.end(), 0U);
      if (seed > 0) std::shuffle(order.begin(), order.end(), std::mt19937(seed));
      EncoderOptions options;
      options.gop = 0;
      auto encoder = *Encoder::create(desc, options);
      auto decoder = *Decoder::create(desc);
      VectorLight light(held.desc, {Interpolation::trilinear, Fill::smooth});
      test::Held client = held;
      const std::size_t bundle = 10 + 7 * seed;
      for (std::size_t at = 0; at < order.size(); at += bundle) {
        const auto these = std::span(order).subspan(at, std::min(bundle, order.size() - at));
        const auto packet = encoder.encode(ConstTextureView(held.texels), Selection(these));
        ASSERT_TRUE(packet.ok());
        ASSERT_EQ(decoder.decode(*packet), Status::ok);
        ASSERT_TRUE(
            std::ranges::is_permutation(::gicodec::test::listed_blocks(decoder, *packet), these));
        // What has come is shown as it is, at once.
        client.texels.assign(decoder.records().begin(), decoder.records().end());
        client.received.assign(decoder.received().begin(), decoder.received().end());
        client.show(light);
        for (const std::uint32_t vertex : std::span(order).first(at + these.size())) {
          ASSERT_TRUE(gicodec::test::same(std::span(client.texels).subspan(vertex * block, block),
                                          std::span(held.texels).subspan(vertex * block, block)));
        }
        for (const Vec3 value : test::picture(light)) ASSERT_TRUE(is_sound(value));
      }
      EXPECT_EQ(client.texels, held.texels);
      EXPECT_EQ(std::ranges::count(client.received, 0), 0);
      pictures.push_back(test::picture(light));
    }
    VectorLight whole(held.desc);
    held.show(whole);
    for (const auto& picture : pictures) EXPECT_EQ(picture, test::picture(whole));
  }
}

TEST(VectorLight, FillsInWhatHasNotCome) {
  test::Held held = served(false);
  held.received.assign(block_count(held.texture()), 0);
  for (const Fill fill : kFills) {
    VectorLight nothing(held.desc, {Interpolation::trilinear, fill});
    for (const Vec3 value : test::picture(nothing)) EXPECT_EQ(value, Vec3{});
    held.show(nothing);
    for (const Vec3 value : test::picture(nothing)) EXPECT_EQ(value, Vec3{});
  }
  const std::size_t last = held.received.size() - 1;
  held.received[last] = 1;
  for (const Fill fill : kFills) {
    VectorLight light(held.desc, {Interpolation::trilinear, fill});
    held.show(light);
    const auto known = static_cast<std::size_t>(std::ranges::count(light.field().known, 1));
    EXPECT_EQ(known, fill == Fill::none ? 1 : held.received.size());
    EXPECT_EQ(light.field().known[last], 1);
    const auto lit =
        std::ranges::count_if(test::picture(light), [](Vec3 v) { return v != Vec3{}; });
    if (fill == Fill::none) {
      EXPECT_LT(lit, 100);
    } else {
      EXPECT_GT(lit, 250);
    }
  }
  // Where half has come, a filled grid is nearer to the whole one.
  const test::Held whole = served(false);
  VectorLight right(whole.desc);
  whole.show(right);
  for (std::size_t i = 0; i < held.received.size(); ++i) held.received[i] = i % 2 == 0 ? 1 : 0;
  std::array<float, kFills.size()> error{};
  for (std::size_t f = 0; f < kFills.size(); ++f) {
    VectorLight light(held.desc, {Interpolation::trilinear, kFills[f]});
    held.show(light);
    for (std::size_t i = 0; i < right.field().vertices.size(); ++i) {
      const Position at = block_position(whole.geometry, static_cast<std::uint32_t>(i));
      ddgi::Surface surface;
      surface.position = {at[0], at[1], at[2]};
      surface.normal = {0, 1, 0};
      const ddgi::SeenSurface seen{surface, {}, 0, 0};
      error[f] += length(light.irradiance(seen) - right.irradiance(seen));
    }
  }
  EXPECT_LT(error[1], 0.5F * error[0]);
  EXPECT_LT(error[2], 0.5F * error[0]);
}

/// What it knew of the update before is gone.
TEST(VectorLight, ShowsTheLastUpdateOnly) {
  const test::Held held = served(false);
  test::Held dark = held;
  std::ranges::fill(dark.texels, std::byte{0});
  VectorLight light(held.desc), fresh(held.desc);
  held.show(light);
  dark.show(light);
  for (const Vec3 value : test::picture(light)) EXPECT_EQ(value, Vec3{});
  held.show(light);
  held.show(fresh);
  EXPECT_EQ(test::picture(light), test::picture(fresh));
}

RC_GTEST_PROP(VectorLight, TakesAnyBytes, (bool floats, std::uint32_t seed, bool ones)) {
  const VolumeGeometry geometry{{3, 2, 4}, {-5, -5, -5}, {4, 8, 3}, {}};
  const std::size_t size = std::size_t{24} * kHemispheres * VectorCode(floats).bytes();
  gicodec::test::Random random(seed);
  test::Held held(geometry, floats, gicodec::test::noise(random, size));
  if (ones) std::ranges::fill(held.texels, std::byte{0xFF});
  if (seed % 2 == 0) {
    for (int i = 0; i < 24; ++i) held.received.push_back(random() % 2);
  }
  for (const Interpolation interpolation : kInterpolations) {
    for (const Fill fill : kFills) {
      VectorLight light(held.desc, {interpolation, fill});
      held.show(light);
      for (const Vec3 value : test::picture(light)) RC_ASSERT(is_sound(value));
    }
  }
}

template <typename Call>
void expect_refused(tools::Exit code, const Call& call) {
  try {
    call();
    ADD_FAILURE() << "not refused";
  } catch (const tools::Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
  }
}

TEST(VectorLight, RefusesOtherVolumes) {
  const VolumeDesc photons = *photon_volume(16, 64, PhotonForm::halves);
  expect_refused(tools::Exit::bad_input, [&] { VectorLight light(photons); });
  expect_refused(tools::Exit::bad_input, [] {
    VectorLight light(VolumeDesc{kKindIrradianceVectors, {}});
  });
  const test::Held held = served(false);
  VectorLight light(held.desc);
  test::Held other = held;
  other.desc.kind = kKindProbes;
  expect_refused(tools::Exit::bad_input, [&] { other.show(light); });
  other = held;
  other.texels.pop_back();
  expect_refused(tools::Exit::bad_input, [&] { other.show(light); });
  other = held;
  other.received.assign(3, 1);
  expect_refused(tools::Exit::bad_input, [&] { other.show(light); });
  expect_refused(tools::Exit::bad_input, [&] { served(true).show(light); });
}

TEST(VectorDrawing, HasWhatItsSettingsSay) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  const ddgi::RayScene rays(scene);
  test::Held held = served(false);
  for (std::size_t i = 0; i < block_count(held.texture()); ++i) held.received.push_back(i % 3 == 0);
  const auto drawn = [&](const std::vector<std::string>& given) {
    const auto light =
        kTracedVectors.light(rays, held.desc, {kTracedVectors.name, kTracedVectors.drawing, given});
    auto& vectors = dynamic_cast<VectorLight&>(*light);
    held.show(vectors);
    return test::picture(vectors);
  };
  std::vector<std::vector<Vec3>> all;
  for (const Interpolation interpolation : kInterpolations) {
    for (const Fill fill : kFills) {
      VectorLight light(held.desc, {interpolation, fill});
      held.show(light);
      const std::string one = interpolation == Interpolation::trilinear ? "trilinear" : "tricubic";
      const std::string other = fill == Fill::none        ? "none"
                                : fill == Fill::push_pull ? "push-pull"
                                                          : "smooth";
      all.push_back(test::picture(light));
      EXPECT_EQ(drawn({"interpolation=" + one, "fill=" + other}), all.back());
    }
  }
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_NE(all[i], all[0]);
  EXPECT_EQ(drawn({}), all[2]);
  expect_refused(tools::Exit::usage, [&] { drawn({"interpolation=cubic"}); });
  expect_refused(tools::Exit::usage, [&] { drawn({"fill=all"}); });
  expect_refused(tools::Exit::usage, [&] { drawn({"vertices=4"}); });
}

}  // namespace
}  // namespace gicodec::vectors
