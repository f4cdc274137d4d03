// The HEVC backend through the C interface.
#include "c_support.h"

#include <gicodec/c/hevc.h>

#include <gtest/gtest.h>

namespace gicodec {
namespace {

using namespace test;

using OwnedHevc = Owned<gicodec_backend, gicodec_hevc_destroy>;

TEST(CHevc, PacketsByTheBackendsThatAreGiven) {
  const auto desc = irradiance();
  CTexture ours(desc), theirs(desc);
  ours.paint(1);
  for (const std::uint32_t packing : {0U, 1U}) {
    auto settings = sized<gicodec_hevc_options>();
    settings.packing = packing;
    const auto hevc =
        made<OwnedHevc>([&](auto out) { return gicodec_hevc_create(&settings, out); });
    ASSERT_TRUE(hevc);
    const gicodec_backend* const backends[] = {hevc.get()};
    auto encoding = sized<gicodec_encoder_options>();
    encoding.backend = "hevc";
    gicodec_encoder* none = nullptr;
    EXPECT_EQ(gicodec_encoder_create(&desc, &encoding, &none), GICODEC_UNKNOWN_BACKEND);
    encoding.backends = backends;
    encoding.backend_count = 1;
    const auto encoder =
        made<OwnedEncoder>([&](auto out) { return gicodec_encoder_create(&desc, &encoding, out); });
    ASSERT_TRUE(encoder);
    std::vector<std::uint8_t> packet(gicodec_encoder_bound(encoder.get(), SIZE_MAX));
    std::size_t size = 0;
    const auto from = ours.const_view();
    ASSERT_EQ(gicodec_encoder_encode(encoder.get(), &from, GICODEC_SELECT_ALL, nullptr, 0,
                                     packet.data(), packet.size(), &size),
              GICODEC_OK);
    EXPECT_EQ(gicodec_encoder_snapshot(encoder.get(), packet.data(), packet.size(), &size),
              GICODEC_UNSUPPORTED_BACKEND);
    const auto plain =
        made<OwnedDecoder>([&](auto out) { return gicodec_decoder_create(&desc, nullptr, out); });
    EXPECT_EQ(gicodec_decoder_decode(plain.get(), packet.data(), size, nullptr),
              GICODEC_BACKEND_MISSING);
    auto decoding = sized<gicodec_decoder_options>();
    decoding.backends = backends;
    decoding.backend_count = 1;
    const auto decoder =
        made<OwnedDecoder>([&](auto out) { return gicodec_decoder_create(&desc, &decoding, out); });
    const auto to = theirs.view();
    ASSERT_EQ(gicodec_decoder_decode(decoder.get(), packet.data(), size, &to), GICODEC_OK);
    EXPECT_EQ(theirs.bytes, ours.bytes);
  }
}

TEST(CHevc, SettingsOutOfRange) {
  gicodec_backend* backend = nullptr;
  auto settings = sized<gicodec_hevc_options>();
  EXPECT_EQ(gicodec_hevc_create(&settings, nullptr), GICODEC_INVALID_ARGUMENT);
  settings.packing = 3;
  EXPECT_EQ(gicodec_hevc_create(&settings, &backend), GICODEC_INVALID_SETTINGS);
  settings.packing = 256;
  EXPECT_EQ(gicodec_hevc_create(&settings, &backend), GICODEC_INVALID_SETTINGS);
  settings.packing = 0;
  settings.layout = 2;
  EXPECT_EQ(gicodec_hevc_create(&settings, &backend), GICODEC_INVALID_SETTINGS);
  settings.struct_size = 4;
  EXPECT_EQ(gicodec_hevc_create(&settings, &backend), GICODEC_INVALID_ARGUMENT);
  EXPECT_EQ(backend, nullptr);
  gicodec_hevc_destroy(nullptr);
}

}  // namespace
}  // namespace gicodec
