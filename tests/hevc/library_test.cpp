// The backend behind the library's own sessions.
#include <gicodec/decoder.h>
#include <gicodec/encoder.h>
#include <gicodec/hevc.h>
#include <gicodec/probes.h>
#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace gicodec::test {
namespace {

struct OwnTexture {
  explicit OwnTexture(const TextureDesc& desc) : bytes(texture_bytes(desc)) {}
  TextureView view() { return {bytes}; }
  std::vector<std::byte> bytes;
};

// Random walks of some records, guard bands included: stale ones are part of the job.
void disturb(std::mt19937& random, OwnTexture& texture) {
  for (std::size_t i = 0; i < texture.bytes.size(); ++i) {
    if (random() % 16 == 0) texture.bytes[i] ^= static_cast<std::byte>(random() & 7U);
  }
}

void expect_equal_mirrors(const TextureDesc& desc, const HevcSettings& settings) {
  const HevcBackend backend(settings);
  EncoderOptions options{.backend = "hevc", .settings = {.preset = "ultrafast"}, .gop = 3};
  options.backends = {&backend};
  auto encoder = Encoder::create(desc, options);
  ASSERT_TRUE(encoder.ok());
  DecoderOptions decoder_options;
  decoder_options.backends = {&backend};
  auto decoder = Decoder::create(desc, decoder_options);
  ASSERT_TRUE(decoder.ok());
  EXPECT_EQ(encoder->lossy(), settings.lossy_qp >= 0);
  std::mt19937 random(3);
  OwnTexture source(desc), known(desc), decoded(desc);
  for (int i = 0; i < 7; ++i) {
    disturb(random, source);
    const auto packet = encoder->encode(source.view());
    ASSERT_TRUE(packet.ok()) << to_string(packet.status());
    ASSERT_EQ(encoder->read(known.view()), Status::ok);
    ASSERT_EQ(decoder->decode(*packet), Status::ok) << i;
    ASSERT_EQ(decoder->read(decoded.view()), Status::ok);
    EXPECT_EQ(decoded.bytes, known.bytes) << i;
    if (settings.lossy_qp < 0) {
      EXPECT_EQ(decoded.bytes, source.bytes) << i;
    }
  }
}

TEST(HevcLibrary, LosslessSessions) {
  for (const auto layout : {HevcLayout::atlas, HevcLayout::packed}) {
    HevcSettings settings;
    settings.layout = layout;
    expect_equal_mirrors(ddgi_irradiance({3, 2, 2}), settings);
    expect_equal_mirrors(ddgi_visibility({2, 2, 1}), settings);
  }
}

TEST(HevcLibrary, LossySessions) {
  for (const auto layout : {HevcLayout::atlas, HevcLayout::packed}) {
    HevcSettings settings;
    settings.layout = layout;
    settings.lossy_qp = 24;
    expect_equal_mirrors(ddgi_irradiance({3, 2, 2}), settings);
  }
}

}  // namespace
}  // namespace gicodec::test
