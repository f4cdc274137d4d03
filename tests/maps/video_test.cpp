#include "maps/video.h"

#include "dump/error.h"
#include "halves.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstring>
#include <random>

namespace gicodec::maps {
namespace {

constexpr std::uint32_t kSide = 64;

IrradianceMapDesc small(std::uint32_t pages, std::uint32_t frames) {
  return {.width = kSide,
          .height = kSide,
          .way = MapWay::video,
          .format = Format::A2B10G10R10_UNORM_PACK32,
          .pages = pages,
          .frames = frames};
}

/// A map all of which is on a surface, lit by a blob that moves.
struct Blob {
  std::vector<MapTexel> texels;
  std::vector<Vec3> values{kSide * kSide};

  Blob() {
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) texels.push_back({i, 0, 0, 0});
    move(0);
  }
  void move(int time) {
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
      const float x = static_cast<float>(i % kSide) - 20 - static_cast<float>(time);
      const float y = static_cast<float>(i / kSide) - 30;
      const float light = std::exp(-(x * x + y * y) / 300);
      values[i] = {0.02F + 0.7F * light, 0.02F + 0.5F * light, 0.03F + 0.3F * light};
    }
  }
};

float farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  float most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec3 d = a[i] - b[i];
    most = std::max({most, std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  }
  return most;
}

RC_GTEST_PROP(MapVideo, TexelsComeBackWithinTheirRounding, ()) {
  const auto channel = [] { return static_cast<float>(*rc::gen::inRange(0, 1000)) / 999; };
  const Vec3 value{channel(), channel(), channel()};
  const Vec3 back = from_video(to_video(value));
  for (const auto& [a, b] : {std::pair(value.x, back.x), {value.y, back.y}, {value.z, back.z}}) {
    const auto codes = [](float v) { return static_cast<int>(ddgi::encode_gamma5(v)); };
    RC_ASSERT(std::abs(codes(a) - codes(b)) <= 3);
  }
}

/// A picture that says it is a keyframe, and is none, is looked at once.
TEST(MapVideo, ChainsThatLieAreRefused) {
  Blob blob;
  VideoEncoder encoder(small(12, 40), 20);
  for (int time = 0; time < 3; ++time) {
    blob.move(time);
    encoder.add(blob.texels, blob.values);
  }
  auto frames = encoder.frames;
  std::memcpy(&frames[20 * 2 + 16], &frames[20 * 2 + 4], 4);  // chain of picture 2: its own pages
  VideoDecoder late(small(12, 40));
  std::vector<Vec3> seen(blob.values.size(), Vec3{9, 9, 9});
  EXPECT_FALSE(late.update(encoder.sizes, encoder.pages, frames, seen));
  EXPECT_FALSE(late.update(encoder.sizes, encoder.pages, encoder.frames, seen));
  EXPECT_EQ(seen, std::vector<Vec3>(seen.size(), Vec3{9, 9, 9}));
  encoder.add(blob.texels, blob.values);
  ASSERT_TRUE(late.update(encoder.sizes, encoder.pages, encoder.frames, seen));
  EXPECT_LT(farthest(seen, blob.values), 0.08F);
}

/// Pages may come later than the record that names them.
TEST(MapVideo, PagesThatAreMissingMayComeLater) {
  Blob blob;
  VideoEncoder encoder(small(12, 40), 20);
  for (int time = 0; time < 2; ++time) encoder.add(blob.texels, blob.values);
  std::vector<Vec3> seen(blob.values.size());
  VideoDecoder late(small(12, 40));
  auto pages = encoder.pages;
  std::uint32_t first = 0;
  std::memcpy(&first, &encoder.frames[20 * 2], 4);
  pages[std::size_t{kMapPageBytes} * first + 8] ^= std::byte{1};
  EXPECT_FALSE(late.update(encoder.sizes, pages, encoder.frames, seen));
  EXPECT_TRUE(late.update(encoder.sizes, encoder.pages, encoder.frames, seen));
  EXPECT_LT(farthest(seen, blob.values), 0.08F);
}

TEST(MapVideo, FollowersAndThoseWhoJoinSeeTheNewestPicture) {
  Blob blob;
  const IrradianceMapDesc desc = small(12, 40);
  VideoEncoder encoder(desc, 20);
  VideoDecoder follower(desc);
  std::vector<Vec3> seen(blob.values.size()), joined(seen.size());
  for (int time = 0; time < 60; ++time) {  // a page each at least: around the ring many times
    blob.move(time / 2);
    encoder.add(blob.texels, blob.values);
    if (time % 3 == 1) continue;  // an update that the follower misses
    ASSERT_TRUE(follower.update(encoder.sizes, encoder.pages, encoder.frames, seen)) << time;
    EXPECT_LT(farthest(seen, blob.values), 0.08F) << time;
    if (time % 7 != 0) continue;
    VideoDecoder late(desc);
    ASSERT_TRUE(late.update(encoder.sizes, encoder.pages, encoder.frames, joined)) << time;
    EXPECT_EQ(joined, seen) << time;
  }
  EXPECT_FALSE(follower.update(encoder.sizes, encoder.pages, encoder.frames, seen))
      << "nothing new";
}

TEST(MapVideo, NamesThePagesThatItNeeds) {
  Blob blob;
  const IrradianceMapDesc desc = small(64, 8);
  const VolumeDesc volume = *irradiance_map_volume(desc);
  VideoEncoder encoder(desc, 10);
  for (int time = 0; time < 5; ++time) {
    blob.move(time);
    encoder.add(blob.texels, blob.values);
  }
  // With the pages that the newest frame names, and no others, it can be decoded.
  std::vector<std::uint32_t> named(64);
  const auto newest = std::span(encoder.frames).subspan(std::size_t{20} * 5, 20);
  named.resize(volume.groups[1].dependencies(newest, named));
  std::vector<std::byte> sizes(encoder.sizes.size()), pages(encoder.pages.size());
  for (const std::uint32_t page : named) {
    std::memcpy(&sizes[std::size_t{2} * page], &encoder.sizes[std::size_t{2} * page], 2);
    std::memcpy(&pages[std::size_t{kMapPageBytes} * page],
                &encoder.pages[std::size_t{kMapPageBytes} * page], kMapPageBytes);
  }
  VideoDecoder decoder(desc);
  std::vector<Vec3> seen(blob.values.size());
  ASSERT_TRUE(decoder.update(sizes, pages, encoder.frames, seen));
  EXPECT_LT(farthest(seen, blob.values), 0.05F);
}

TEST(MapVideo, APictureWithoutRoomIsRefused) {
  Blob blob;
  std::mt19937 random(3);
  for (Vec3& value : blob.values) value = {static_cast<float>(random() % 1000) / 1000, 0, 0};
  VideoEncoder encoder(small(2, 2), 0);
  EXPECT_THROW(encoder.add(blob.texels, blob.values), tools::Error);
}

TEST(MapVideo, TakesAnyPagesAndFrames) {
  std::mt19937 random(5);
  Blob blob;
  const IrradianceMapDesc desc = small(32, 4);
  VideoEncoder encoder(desc, 24);
  for (int time = 0; time < 3; ++time) encoder.add(blob.texels, blob.values);
  VideoDecoder decoder(desc);
  std::vector<Vec3> seen(blob.values.size());
  for (int round = 0; round < 200; ++round) {
    auto sizes = encoder.sizes, pages = encoder.pages, frames = encoder.frames;
    auto& hit = round % 3 == 0 ? sizes : round % 3 == 1 ? pages : frames;
    for (int i = 0; i < 1 + round % 8; ++i) {
      hit[random() % hit.size()] = static_cast<std::byte>(random());
    }
    if (round == 0) std::fill(frames.begin(), frames.end(), std::byte{0xFF});
    static_cast<void>(decoder.update(sizes, pages, frames, seen));
    for (const Vec3 value : seen) ASSERT_TRUE(std::isfinite(value.x + value.y + value.z));
  }
  // And is none the worse for it.
  encoder.add(blob.texels, blob.values);
  VideoDecoder fresh(desc);
  ASSERT_TRUE(fresh.update(encoder.sizes, encoder.pages, encoder.frames, seen));
  EXPECT_LT(farthest(seen, blob.values), 0.08F);
}

TEST(MapVideo, AClientShowsTheServersMap) {
  const ddgi::Scene scene = test::halves();
  MapServer server(scene, test::options({"way=video", "gather=texels", "qp=8"}), 2, {});
  ddgi::RayScene rays(scene);
  server.update(0);
  const test::Held first(server);
  MapLight light(rays, first.desc);
  light.set_filter(0);
  first.show(light, 0);
  for (int update = 1; update < 3; ++update) {
    server.update(update * 0.2);
    test::Held(server).show(light, update * 0.2);
    double error = 0;
    for (const MapTexel& texel : server.texels()) {
      const Vec3 d = light.values()[texel.place] - server.values()[texel.place];
      error += double{dot(d, d)} / static_cast<double>(3 * server.texels().size());
    }
    EXPECT_LT(std::sqrt(error), 0.01) << update;
  }
}

}  // namespace
}  // namespace gicodec::maps
