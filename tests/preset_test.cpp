// Encoders whose preset changes between packets.
#include "support.h"

#include <gicodec/photons.h>
#include <gicodec/volume_encoder.h>

#include <gtest/gtest.h>

namespace gicodec {
namespace {

using namespace test;

/// A packet has the bytes of its preset, and the decoder need not know of it.
TEST(Preset, ChangesAtAnyPacket) {
  Random random(18);
  TextureDesc map = probe_texture(Format::B10G11R11_UFLOAT_PACK32, {5, 3, 1}, 16, 0);
  map.model = Model::continuous;
  for (const auto& desc : {ddgi_irradiance({5, 4, 3}), ddgi_visibility({3, 2, 2}), map}) {
    constexpr const char* kPresets[] = {"strong", "turbo", "fast", "", "turbo", "strong", "fast"};
    Texture texture(desc);
    auto encoder = *Encoder::create(desc);
    auto decoder = *Decoder::create(desc);
    for (const char* preset : kPresets) {
      texture.fill(Fill::small, random);
      EncoderOptions options;
      options.settings.preset = preset;
      auto anew = *Encoder::create(desc, options);
      ASSERT_EQ(encoder.set_preset(preset), Status::ok);
      const auto packet = encoder.encode(std::as_const(texture).view());
      ASSERT_EQ(decoder.decode(*packet), Status::ok);
      EXPECT_TRUE(contents(decoder) == texture.blocks());
      const auto first = anew.encode(std::as_const(texture).view());
      if (decoder.sequence() == 1) {
        EXPECT_TRUE(*packet == *first);
      }
      const auto snapshot = encoder.snapshot();
      auto late = *Decoder::create(desc);
      ASSERT_EQ(late.decode(*snapshot), Status::ok);
      EXPECT_TRUE(contents(late) == texture.blocks());
    }
    EXPECT_EQ(encoder.set_preset("slow"), Status::invalid_settings);
  }
  auto other = *Encoder::create(map, {.backend = "zstd"});
  EXPECT_EQ(other.set_preset("fast"), Status::unsupported_backend);
}

TEST(Preset, OfAVolumeIsThatOfEachTexture) {
  auto encoder = *VolumeEncoder::create(*photon_volume(3, 16));
  EXPECT_EQ(encoder.set_preset(0, "strong"), Status::ok);
  EXPECT_EQ(encoder.set_preset(2, "turbo"), Status::ok);
  EXPECT_EQ(encoder.set_preset(2, "slow"), Status::invalid_settings);
  EXPECT_EQ(encoder.set_preset(3, "fast"), Status::unknown_texture);
}

}  // namespace
}  // namespace gicodec
