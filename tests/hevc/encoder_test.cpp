// Choice of encoders, lossy coding, settings.
#include "hevc/session.h"

#include <gtest/gtest.h>

namespace gicodec::test {
namespace {

HevcSettings with_encoder(std::string names) {
  HevcSettings settings;
  settings.encoder = std::move(names);
  return settings;
}

TEST(HevcEncoder, FfmpegEncodersRoundTrip) {
  for (const auto packing : {HevcPacking::paper, HevcPacking::planes}) {
    for (const TextureDesc& desc : {ddgi_irradiance({5, 2, 2}), ddgi_visibility({3, 1, 2})}) {
      HevcSettings settings = with_encoder("libx265");
      settings.packing = packing;
      EXPECT_EQ(*HevcBackend(settings).encoder_in_use(desc, {}), "libx265");
      Sender sender(desc, settings);
      Receiver libde265(desc, "libde265"), ffmpeg(desc, "ffmpeg");
      for (int i = 0; i < 6; ++i) {
        const Update update =
            sender.next(some_blocks(desc, sender.random(), 0.5), i % 4 == 0, i == 0 ? 8 : 4);
        ASSERT_EQ(sender.status(), Status::ok) << i;
        ASSERT_EQ(libde265.receive(update), Status::ok) << i;
        EXPECT_EQ(libde265.records(), update.records) << i;
        ASSERT_EQ(ffmpeg.receive(update), Status::ok) << i;
        EXPECT_EQ(ffmpeg.records(), update.records) << i;
      }
    }
  }
}

// Names that do not exist, are no HEVC encoders or have no hardware are passed over, silently.
TEST(HevcEncoder, FallsThroughToTheNextName) {
  const TextureDesc desc = ddgi_irradiance({2, 2, 2});
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const auto chosen = [&](const char* names) {
    return *HevcBackend(with_encoder(names)).encoder_in_use(desc, {});
  };
  EXPECT_EQ(chosen("no_such_encoder"), "x265");
  EXPECT_EQ(chosen("mpeg4,png,libx265"), "libx265");
  EXPECT_EQ(chosen("no_such_encoder,x265,libx265"), "x265");
  const std::string hardware = chosen("hevc_nvenc,hevc_vaapi,hevc_v4l2m2m,libx265");
  EXPECT_FALSE(hardware.empty());
  Sender sender(desc, with_encoder("hevc_nvenc,hevc_vaapi,libx265"));
  Receiver receiver(desc, "ffmpeg");
  for (int i = 0; i < 3; ++i) {
    const Update update = sender.next(all_blocks(desc), i == 0, 4);
    EXPECT_EQ(receiver.receive(update), Status::ok);
    EXPECT_EQ(receiver.records(), update.records);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST(HevcEncoder, RefusesBadSettings) {
  const TextureDesc colour = ddgi_irradiance({2, 1, 1});
  const auto status = [&](const HevcSettings& settings, const BackendSettings& common = {},
                          const TextureDesc& desc = ddgi_irradiance({2, 1, 1})) {
    return HevcBackend(settings).make_encoder(desc, common).status();
  };
  EXPECT_EQ(status({}), Status::ok);
  EXPECT_EQ(status(with_encoder("")), Status::invalid_settings);
  EXPECT_EQ(status(with_encoder("libx265,")), Status::invalid_settings);
  EXPECT_EQ(status({}, {.preset = "quickest"}), Status::invalid_settings);
  EXPECT_EQ(status({}, {.level = 3}), Status::invalid_settings);
  EXPECT_EQ(status({}, {.threads = 0}), Status::invalid_settings);
  EXPECT_EQ(status({.lossy_qp = 52}), Status::invalid_settings);
  EXPECT_EQ(status({.packing = HevcPacking::luma}), Status::invalid_settings);
  EXPECT_EQ(status({.encoder = "libx265", .lossy_qp = 20}), Status::invalid_settings);
  EXPECT_EQ(status({.lossy_qp = 20}, {}, ddgi_visibility({2, 1, 1})), Status::invalid_settings);
  EXPECT_EQ(status({.decoder = "vlc"}), Status::invalid_settings);
  EXPECT_EQ(status({}, {}, TextureDesc{}), Status::unsupported_format);
  EXPECT_EQ(HevcBackend({.decoder = "vlc"}).make_decoder(colour).status(),
            Status::invalid_settings);
  EXPECT_EQ(HevcBackend({.decoder_threads = 0}).make_decoder(colour).status(),
            Status::invalid_settings);
}

// Smooth colours with alpha varying, as a lossy coder should like them.
Update smooth(const TextureDesc& desc, bool keyframe, unsigned shift) {
  Update update{.blocks = all_blocks(desc), .records = {}, .payload = {}, .keyframe = keyframe};
  update.records.resize(update.blocks.size() * block_bytes(desc));
  for (std::uint32_t i = 0; i < update.records.size() / 4; ++i) {
    const std::uint32_t x = i % desc.block.x, y = i / desc.block.x % desc.block.x;
    const std::uint32_t texel = (i % 7 == 0 ? 3U : 1U) << 30 | (300 + 20 * x + shift) << 20 |
                                (400 + 13 * y + i % 3) << 10 | (600 + 5 * x + 7 * y);
    std::memcpy(&update.records[4 * i], &texel, sizeof texel);
  }
  return update;
}

TEST(HevcLossy, EncoderKnowsWhatIsDecoded) {
  const TextureDesc desc = ddgi_irradiance({6, 2, 2});
  for (const auto packing : {HevcPacking::paper, HevcPacking::planes, HevcPacking::luma}) {
    for (const auto layout : {HevcLayout::atlas, HevcLayout::packed}) {
      for (const char* decoder : {"libde265", "ffmpeg"}) {
        Sender sender(desc,
                      {.packing = packing, .layout = layout, .decoder = decoder, .lossy_qp = 30});
        ASSERT_EQ(sender.status(), Status::ok);
        EXPECT_TRUE(sender.encoder().lossy());
        Receiver libde265(desc, "libde265"), ffmpeg(desc, "ffmpeg");
        for (unsigned i = 0; i < 5; ++i) {
          const Update original = smooth(desc, i == 0, 11 * i);
          const Update update = sender.send(original);
          ASSERT_EQ(sender.status(), Status::ok);
          EXPECT_NE(update.records, original.records);
          for (std::size_t k = 3; k < update.records.size(); k += 4) {
            ASSERT_EQ(update.records[k] & std::byte{0xC0}, original.records[k] & std::byte{0xC0});
          }
          ASSERT_EQ(libde265.receive(update), Status::ok);
          EXPECT_EQ(libde265.records(), update.records);
          ASSERT_EQ(ffmpeg.receive(update), Status::ok);
          EXPECT_EQ(ffmpeg.records(), update.records);
        }
      }
    }
  }
}

TEST(HevcLossy, TakesLessRoomThanLossless) {
  const TextureDesc desc = ddgi_irradiance({8, 4, 2});
  Sender lossless(desc, {}), fine(desc, {.lossy_qp = 10}), coarse(desc, {.lossy_qp = 40});
  EXPECT_FALSE(lossless.encoder().lossy());
  const std::size_t sizes[] = {lossless.send(smooth(desc, true, 0)).payload.size(),
                               fine.send(smooth(desc, true, 0)).payload.size(),
                               coarse.send(smooth(desc, true, 0)).payload.size()};
  EXPECT_LT(sizes[1], sizes[0]);
  EXPECT_LT(sizes[2], sizes[1]);
}

TEST(HevcEncoder, ThreadsDoNotChangeRecords) {
  const TextureDesc desc = ddgi_irradiance({8, 4, 4});
  HevcSettings settings;
  settings.decoder_threads = 2;
  auto encoder = HevcBackend(settings).make_encoder(desc, {.preset = "ultrafast", .threads = 2});
  ASSERT_TRUE(encoder.ok());
  for (const char* name : {"libde265", "ffmpeg"}) {
    settings.decoder = name;
    auto decoder = HevcBackend(settings).make_decoder(desc);
    ASSERT_TRUE(decoder.ok());
    const std::vector<std::byte> mirror(block_count(desc) * block_bytes(desc));
    for (unsigned i = 0; i < 3; ++i) {
      Update update = smooth(desc, i == 0, 7 * i);
      ASSERT_EQ((*encoder)->encode({desc,
                                    update.blocks,
                                    {update.records.data(), block_bytes(desc)},
                                    {{mirror.data(), block_bytes(desc)}},
                                    i == 0},
                                   update.payload),
                Status::ok);
      std::vector<std::byte> records(update.records.size());
      ASSERT_EQ((*decoder)->decode({desc, update.blocks, update.payload, {}, records, i == 0}),
                Status::ok);
      EXPECT_EQ(records, update.records);
    }
  }
}

}  // namespace
}  // namespace gicodec::test
