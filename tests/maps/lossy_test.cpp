// Maps whose texels HEVC codes with a loss.
#include "../tools/dump_support.h"
#include "common/backend_flags.h"
#include "common/container_input.h"
#include "dump/error.h"
#include "halves.h"
#include "programs/feed_container.h"

#include <gicodec/inspect.h>
#include <gicodec/volume_decoder.h>
#include <gicodec/volume_encoder.h>

#include <gtest/gtest.h>

#include <cmath>

namespace gicodec::maps {
namespace {

constexpr std::size_t kIrradiance = 1;  // texture

/// The error of what a client shows, as a root of a mean square.
double error_of(const MapServer& server, const MapLight& light) {
  double error = 0;
  for (const MapTexel& texel : server.texels()) {
    const Vec3 d = light.values()[texel.place] - server.values()[texel.place];
    error += double{dot(d, d)} / static_cast<double>(3 * server.texels().size());
  }
  return std::sqrt(error);
}

TEST(LossyMaps, AClientShowsNearlyTheServersMap) {
  const ddgi::Scene scene = test::halves();
  ddgi::RayScene rays(scene);
  std::array<std::size_t, 2> bytes{};
  for (const int qp : {8, 24}) {
    MapServer server(scene, test::options({"way=map", "gather=texels", "qp=8"}), 2, {});
    server.update(0);
    test::Held held(server);
    const auto hevc = tools::lossy_hevc(qp);
    auto encoder = tools::take(
        VolumeEncoder::create(held.desc, {.texture_backends = {nullptr, hevc.get(), nullptr}}),
        "encoder");
    auto decoder =
        tools::take(VolumeDecoder::create(held.desc, {.backends = {hevc.get()}}), "decoder");
    MapLight light(rays, held.desc);
    light.set_filter(0);
    for (int update = 0; update < 4; ++update) {
      if (update > 0) server.update(update * 0.2);
      const auto textures = server.textures();
      const std::vector<ConstTextureView> views(textures.begin(), textures.end());
      const std::vector<Packet> packets = tools::take(encoder.encode(views), "packets");
      for (std::size_t i = 0; i < packets.size(); ++i)
        EXPECT_EQ(peek(packets[i])->lossy, i == kIrradiance) << i;
      bytes[qp == 8 ? 0 : 1] += packets[kIrradiance].size();
      ASSERT_EQ(decoder.decode(packets), Status::ok);
      for (std::uint8_t i = 0; i < packets.size(); ++i) {
        ASSERT_EQ(decoder.read(i, TextureView{held.texels[i]}), Status::ok);
      }
      EXPECT_EQ(held.texels[0], textures[0]) << "which texels exist is exact";
      EXPECT_NE(held.texels[kIrradiance], textures[kIrradiance]);
      held.show(light, update * 0.2);
      EXPECT_LT(error_of(server, light), qp == 8 ? 0.01 : 0.05) << update;
    }
  }
  EXPECT_LT(bytes[1], bytes[0] / 2);
}

/// The same at every end: what the encoder holds is what decoders have.
TEST(LossyMaps, TheEncoderHoldsWhatIsDecoded) {
  const ddgi::Scene scene = test::halves();
  MapServer server(scene, test::options({"way=map", "gather=texels", "qp=20"}), 2, {});
  server.update(0);
  const VolumeDesc desc = *irradiance_map_volume(server.desc());
  const TextureDesc& texels = desc.groups[0].textures[kIrradiance].desc;
  const auto hevc = tools::lossy_hevc(20);
  EncoderOptions options;
  options.backend = "hevc";
  options.backends = {hevc.get()};
  Encoder encoder = tools::take(Encoder::create(texels, options), "encoder");
  EXPECT_TRUE(encoder.lossy());
  DecoderOptions decoding;
  decoding.backends = {hevc.get()};
  Decoder decoder = tools::take(Decoder::create(texels, decoding), "decoder");
  for (int update = 1; update < 5; ++update) {
    const auto textures = server.textures();
    ASSERT_EQ(encoder.set_presence(textures[0]), Status::ok);
    ASSERT_EQ(decoder.set_presence(textures[0]), Status::ok);
    const auto packet = encoder.encode(ConstTextureView(textures[kIrradiance]), Selection::all());
    ASSERT_TRUE(packet.ok());
    std::vector<std::byte> decoded(textures[kIrradiance].size()), held(decoded.size());
    ASSERT_EQ(decoder.decode(*packet, TextureView{decoded}), Status::ok);
    ASSERT_EQ(encoder.read(TextureView{held}), Status::ok);
    EXPECT_EQ(decoded, held) << update;
    server.update(update * 0.2);
  }
}

TEST(LossyMaps, ContainersSayIt) {
  const ddgi::Scene scene = test::halves();
  const std::vector<std::string> set{"size=64", "way=map",  "gather=texels",
                                     "rays=16", "warmup=1", "qp=30"};
  kinds::Feed feed = kTracedMaps.trace({scene, {kTracedMaps.name, kTracedMaps.settings, set}});
  tools::TemporaryDirectory directory;
  const std::string path = directory.path("x.gic");
  kinds::FeedContainer container(path, feed, {0, 5}, "native");
  for (int frame = 0; frame < 3; ++frame) {
    container.add(static_cast<std::uint64_t>(frame), feed.next({.time = frame * 0.2}));
  }
  container.finish();
  tools::ContainerInput input(path);
  const auto& textures = input.description().textures;
  EXPECT_EQ(textures[0].largest_error, 0);
  EXPECT_TRUE(std::isinf(textures[kIrradiance].largest_error));
  EXPECT_EQ(textures[2].largest_error, 0);
}

TEST(LossyMaps, OnlyMapsHaveAQuantiser) {
  EXPECT_THROW(test::options({"qp=20"}), tools::Error);
  EXPECT_THROW(test::options({"way=map", "qp=52"}), tools::Error);
  EXPECT_EQ(test::options({"way=map"}).qp, -1);
  EXPECT_EQ(test::options({"way=map", "qp=20"}).desc.format, Format::A2B10G10R10_UNORM_PACK32);
}

}  // namespace
}  // namespace gicodec::maps
