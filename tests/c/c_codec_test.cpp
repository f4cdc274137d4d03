// Encoders and decoders through the C interface give the library's own bytes and texels.
#include "c_support.h"
#include "shapes.h"

#include <gicodec/textures.h>

#include <gtest/gtest.h>

#include <cstring>

namespace gicodec {
namespace {

using namespace test;

std::span<const std::byte> as_bytes(const std::vector<std::uint8_t>& bytes) {
  return std::as_bytes(std::span(bytes));
}

TEST(CCodec, PacketsAreThoseOfTheLibrary) {
  for (std::uint32_t place = 0; place < gicodec_format_count(); ++place) {
    auto desc = sized<gicodec_texture_desc>();
    ASSERT_EQ(gicodec_map_texture(23, 9, 2, 8, 4, 1, gicodec_format_at(place), &desc), GICODEC_OK);
    CTexture ours(desc), theirs(desc);
    const Record record(static_cast<Format>(gicodec_format_at(place)));
    const TextureDesc texture = map_texture(record, {23, 9, 2}, {8, 4, 1});
    auto library = *Encoder::create(texture, {.texture_id = 7});
    auto options = sized<gicodec_encoder_options>();
    options.texture_id = 7;
    const auto encoder =
        made<OwnedEncoder>([&](auto out) { return gicodec_encoder_create(&desc, &options, out); });
    const auto decoder =
        made<OwnedDecoder>([&](auto out) { return gicodec_decoder_create(&desc, nullptr, out); });
    ASSERT_TRUE(encoder && decoder);
    for (unsigned frame = 0; frame < 3; ++frame) {
      ours.paint(frame);
      const auto from = ours.const_view();
      const auto to = theirs.view();
      std::vector<std::uint8_t> packet(gicodec_encoder_bound(encoder.get(), SIZE_MAX));
      std::size_t size = 0;
      ASSERT_EQ(gicodec_encoder_encode(encoder.get(), &from, GICODEC_SELECT_CHANGED, nullptr, 0,
                                       packet.data(), packet.size(), &size),
                GICODEC_OK);
      packet.resize(size);
      const auto expected = *library.encode(ConstTextureView(as_bytes(ours.bytes)));
      EXPECT_TRUE(same(as_bytes(packet), expected)) << gicodec_format_name(desc.format);
      ASSERT_EQ(gicodec_decoder_decode(decoder.get(), packet.data(), size, &to), GICODEC_OK);
      EXPECT_EQ(theirs.bytes, ours.bytes);
    }
  }
}

TEST(CCodec, RecordsOfTheApplicationsOwn) {
  auto desc = sized<gicodec_texture_desc>();
  ASSERT_EQ(gicodec_map_texture(16, 16, 1, 8, 8, 1, gicodec_format_from_name("R8G8_UNORM"), &desc),
            GICODEC_OK);
  desc.format = 0;
  desc.record_bytes = 5;
  desc.component_count = 2;
  desc.components[0] = {"depth", 0, 24, GICODEC_COMPONENT_UINT};
  desc.components[1] = {"rest", 24, 16, GICODEC_COMPONENT_OPAQUE};
  // Two bits of a component lie in another aligned word.
  EXPECT_EQ(gicodec_texture_desc_check(&desc), GICODEC_UNSUPPORTED_FORMAT);
  desc.components[1].bits = 8;
  desc.record_bytes = 4;
  ASSERT_EQ(gicodec_texture_desc_check(&desc), GICODEC_OK);
  auto info = sized<gicodec_texture_info>();
  ASSERT_EQ(gicodec_texture_desc_info(&desc, &info), GICODEC_OK);
  EXPECT_EQ(info.texture_bytes, 16U * 16 * 4);
  EXPECT_EQ(info.block_bytes, 8U * 8 * 4);
  EXPECT_EQ(info.blocks, 4U);
  desc.component_count = GICODEC_MAX_COMPONENTS + 1;
  EXPECT_EQ(gicodec_texture_desc_check(&desc), GICODEC_UNSUPPORTED_FORMAT);
}

TEST(CCodec, FormatsFillInTheirComponents) {
  auto desc = irradiance();
  EXPECT_EQ(desc.component_count, 4U);
  EXPECT_STREQ(desc.components[0].name, "R");
  desc.record_bytes = desc.component_count = 0;
  std::memset(desc.components, 0, sizeof desc.components);
  ASSERT_EQ(gicodec_texture_desc_complete(&desc), GICODEC_OK);
  EXPECT_EQ(desc.record_bytes, 4U);
  EXPECT_EQ(desc.components[3].bits, 2);
  std::uint64_t origin[4] = {};
  ASSERT_EQ(gicodec_texture_desc_origin(&desc, 5, origin), GICODEC_OK);
  EXPECT_EQ(origin[0], 5U * 10);
  EXPECT_EQ(gicodec_texture_desc_origin(&desc, 24, origin), GICODEC_BLOCK_OUT_OF_RANGE);
}

TEST(CCodec, AListOfBlocksAndASnapshot) {
  const auto desc = irradiance();
  CTexture ours(desc), theirs(desc);
  const auto encoder =
      made<OwnedEncoder>([&](auto out) { return gicodec_encoder_create(&desc, nullptr, out); });
  const auto decoder =
      made<OwnedDecoder>([&](auto out) { return gicodec_decoder_create(&desc, nullptr, out); });
  std::vector<std::uint8_t> packet(gicodec_encoder_bound(encoder.get(), SIZE_MAX));
  std::size_t size = 0;
  // Nothing to take a snapshot of yet.
  EXPECT_EQ(gicodec_encoder_snapshot(encoder.get(), packet.data(), packet.size(), &size),
            GICODEC_OUT_OF_ORDER);
  ours.paint(1);
  const auto view = ours.const_view();
  const std::uint32_t blocks[] = {20, 3, 7};
  ASSERT_EQ(gicodec_encoder_encode(encoder.get(), &view, GICODEC_SELECT_LIST, blocks, 3,
                                   packet.data(), packet.size(), &size),
            GICODEC_OK);
  ASSERT_EQ(gicodec_decoder_decode(decoder.get(), packet.data(), size, nullptr), GICODEC_OK);
  std::size_t received = 0;
  const std::uint8_t* const flags = gicodec_decoder_received(decoder.get(), &received);
  ASSERT_EQ(received, 24U);
  EXPECT_TRUE(flags[3] != 0 && flags[7] != 0 && flags[20] != 0 && flags[4] == 0);

  std::size_t needed = 0;
  EXPECT_EQ(gicodec_encoder_snapshot(encoder.get(), nullptr, 0, &needed), GICODEC_BUFFER_TOO_SMALL);
  packet.resize(needed);
  ASSERT_EQ(gicodec_encoder_snapshot(encoder.get(), packet.data(), needed, &size), GICODEC_OK);
  const auto late =
      made<OwnedDecoder>([&](auto out) { return gicodec_decoder_create(&desc, nullptr, out); });
  ASSERT_EQ(gicodec_decoder_decode(late.get(), packet.data(), size, nullptr), GICODEC_OK);
  EXPECT_EQ(gicodec_decoder_state_hash(late.get()), gicodec_decoder_state_hash(decoder.get()));
  EXPECT_EQ(gicodec_decoder_sequence(late.get()), gicodec_encoder_sequence(encoder.get()));

  const std::uint32_t twice[] = {3, 3}, beyond[] = {24};
  EXPECT_EQ(gicodec_encoder_encode(encoder.get(), &view, GICODEC_SELECT_LIST, twice, 2,
                                   packet.data(), packet.size(), &size),
            GICODEC_BLOCK_REPEATED);
  EXPECT_EQ(gicodec_encoder_encode(encoder.get(), &view, GICODEC_SELECT_LIST, beyond, 1,
                                   packet.data(), packet.size(), &size),
            GICODEC_BLOCK_OUT_OF_RANGE);
  EXPECT_EQ(gicodec_encoder_encode(encoder.get(), &view, 3, nullptr, 0, packet.data(),
                                   packet.size(), &size),
            GICODEC_INVALID_ARGUMENT);
}

TEST(CCodec, ASmallBufferChangesNothing) {
  const auto desc = irradiance();
  CTexture ours(desc);
  ours.paint(0);
  const auto view = ours.const_view();
  const auto encoder =
      made<OwnedEncoder>([&](auto out) { return gicodec_encoder_create(&desc, nullptr, out); });
  std::uint8_t small[16];
  std::size_t size = 0;
  EXPECT_EQ(gicodec_encoder_encode(encoder.get(), &view, GICODEC_SELECT_ALL, nullptr, 0, small,
                                   sizeof small, &size),
            GICODEC_BUFFER_TOO_SMALL);
  EXPECT_EQ(gicodec_encoder_sequence(encoder.get()), 0U);
  std::vector<std::uint8_t> packet(size);
  EXPECT_EQ(gicodec_encoder_encode(encoder.get(), &view, GICODEC_SELECT_ALL, nullptr, 0,
                                   packet.data(), packet.size(), &size),
            GICODEC_OK);
  EXPECT_EQ(gicodec_encoder_sequence(encoder.get()), 1U);
  auto info = sized<gicodec_packet_info>();
  ASSERT_EQ(gicodec_packet_peek(packet.data(), size, &info), GICODEC_OK);
  EXPECT_STREQ(gicodec_backend_name(info.backend), "native");
  EXPECT_EQ(info.header_size + info.index_size + info.guard_band_size + info.payload_size, size);
}

TEST(CCodec, CutAndChangedPacketsAreRefused) {
  const auto desc = irradiance();
  CTexture ours(desc);
  ours.paint(0);
  const auto view = ours.const_view();
  const auto encoder =
      made<OwnedEncoder>([&](auto out) { return gicodec_encoder_create(&desc, nullptr, out); });
  std::vector<std::uint8_t> packet(gicodec_encoder_bound(encoder.get(), SIZE_MAX));
  std::size_t size = 0;
  ASSERT_EQ(gicodec_encoder_encode(encoder.get(), &view, GICODEC_SELECT_ALL, nullptr, 0,
                                   packet.data(), packet.size(), &size),
            GICODEC_OK);
  const auto decoder =
      made<OwnedDecoder>([&](auto out) { return gicodec_decoder_create(&desc, nullptr, out); });
  for (std::size_t cut = 0; cut < size; ++cut) {
    const std::vector<std::uint8_t> shorter(packet.begin(), packet.begin() + cut);
    EXPECT_NE(gicodec_decoder_decode(decoder.get(), shorter.data(), cut, nullptr), GICODEC_OK);
  }
  gicodec_decoder_cancel(decoder.get(), 1);
  EXPECT_EQ(gicodec_decoder_decode(decoder.get(), packet.data(), size, nullptr), GICODEC_CANCELLED);
  gicodec_decoder_cancel(decoder.get(), 0);
  EXPECT_EQ(gicodec_decoder_decode(decoder.get(), packet.data(), size, nullptr), GICODEC_OK);
}

TEST(CCodec, VolumesOfEveryLayoutAndKind) {
  std::vector<OwnedVolume> volumes;
  for (std::uint32_t i = 0; i < gicodec_layout_count(); ++i) {
    const char* const name = gicodec_layout_name(i);
    EXPECT_NE(gicodec_layout_summary(i), nullptr);
    volumes.push_back(made<OwnedVolume>(
        [&](auto out) { return gicodec_volume_desc_from_layout(name, 4, 4, 4, out); }));
    EXPECT_TRUE(volumes.back()) << name;
  }
  volumes.push_back(
      made<OwnedVolume>([](auto out) { return gicodec_photon_volume(3, 64, 1, out); }));
  volumes.push_back(made<OwnedVolume>([](auto out) { return gicodec_voxel_volume(5, 4, 0, out); }));
  volumes.push_back(
      made<OwnedVolume>([](auto out) { return gicodec_ao_point_volume(6, 7, 2, out); }));
  volumes.push_back(made<OwnedVolume>(
      [](auto out) { return gicodec_irradiance_vector_volume(3, 2, 4, 1, out); }));
  for (const OwnedVolume& volume : volumes) {
    ASSERT_TRUE(volume);
    EXPECT_EQ(gicodec_volume_desc_check(volume.get()), GICODEC_OK);
    // What a kind writes it reads again, but for layouts.
    std::size_t size = 0;
    (void)gicodec_volume_desc_write(volume.get(), nullptr, 0, &size);
    std::vector<std::uint8_t> written(size);
    ASSERT_EQ(gicodec_volume_desc_write(volume.get(), written.data(), size, &size), GICODEC_OK);
    const std::uint32_t kind = gicodec_volume_desc_kind(volume.get());
    const auto back = made<OwnedVolume>(
        [&](auto out) { return gicodec_volume_desc_read(kind, written.data(), size, out); });
    ASSERT_TRUE(back) << gicodec_kind_name(kind);
    ASSERT_EQ(gicodec_volume_desc_textures(back.get()), gicodec_volume_desc_textures(volume.get()));
    for (std::size_t cut = 0; cut < size; ++cut) {
      EXPECT_FALSE(made<OwnedVolume>(
          [&](auto out) { return gicodec_volume_desc_read(kind, written.data(), cut, out); }));
    }

    const auto encoder = made<OwnedVolumeEncoder>(
        [&](auto out) { return gicodec_volume_encoder_create(volume.get(), nullptr, out); });
    const auto decoder = made<OwnedVolumeDecoder>(
        [&](auto out) { return gicodec_volume_decoder_create(volume.get(), nullptr, out); });
    ASSERT_TRUE(encoder && decoder);
    std::vector<CTexture> ours, theirs;
    std::vector<gicodec_const_view> views;
    for (std::uint32_t t = 0; t < gicodec_volume_desc_textures(volume.get()); ++t) {
      auto desc = sized<gicodec_texture_desc>();
      ASSERT_EQ(gicodec_volume_desc_texture(volume.get(), t, &desc), GICODEC_OK);
      EXPECT_NE(gicodec_volume_desc_group_of(volume.get(), t), GICODEC_NO_GROUP);
      ours.emplace_back(desc);
      theirs.emplace_back(desc);
      // Presence of zeros: nothing exists in the textures that depend on it.
      if (kind != 5 && kind != 6 && kind != 7) ours.back().paint(t);
      views.push_back(ours.back().const_view());
    }
    // The count is compared before a view is touched.
    EXPECT_EQ(gicodec_volume_encoder_encode(encoder.get(), views.data(), views.size() + 1,
                                            GICODEC_SELECT_ALL, nullptr, 0),
              GICODEC_INVALID_ARGUMENT);
    ASSERT_EQ(gicodec_volume_encoder_encode(encoder.get(), views.data(), views.size(),
                                            GICODEC_SELECT_ALL, nullptr, 0),
              GICODEC_OK)
        << gicodec_kind_name(kind);
    for (std::uint32_t p = 0; p < gicodec_volume_encoder_packets(encoder.get()); ++p) {
      const std::uint8_t* const packet = gicodec_volume_encoder_packet(encoder.get(), p, &size);
      ASSERT_EQ(gicodec_volume_decoder_decode(decoder.get(), packet, size), GICODEC_OK);
    }
    for (std::uint32_t t = 0; t < theirs.size(); ++t) {
      const auto to = theirs[t].view();
      if (t + 1 < theirs.size()) {  // the last packet was of another texture
        const std::uint32_t* const none = gicodec_volume_decoder_changed(decoder.get(), t, &size);
        ASSERT_EQ(size, 0U);
        ASSERT_EQ(gicodec_volume_decoder_read(decoder.get(), t, &to, none, size), GICODEC_OK);
        EXPECT_EQ(theirs[t].bytes, std::vector<std::uint8_t>(theirs[t].bytes.size()));
      }
      ASSERT_EQ(gicodec_volume_decoder_read(decoder.get(), t, &to, nullptr, 0), GICODEC_OK);
      std::vector<std::uint8_t> encoded(theirs[t].bytes.size());
      auto held = sized<gicodec_view>();
      held.bytes = encoded.data();
      held.size = encoded.size();
      ASSERT_EQ(gicodec_volume_encoder_read(encoder.get(), t, &held), GICODEC_OK);
      EXPECT_EQ(theirs[t].bytes, encoded);
    }
  }
}

TEST(CCodec, VolumesAsJson) {
  auto desc = irradiance(2, 1, 1);
  const auto volume = room(desc);
  std::size_t size = 0;
  ASSERT_EQ(gicodec_volume_desc_json(volume.get(), nullptr, 0, &size), GICODEC_BUFFER_TOO_SMALL);
  std::vector<char> text(size);
  ASSERT_EQ(gicodec_volume_desc_json(volume.get(), text.data(), size, &size), GICODEC_OK);
  EXPECT_STREQ(
      text.data(),
      R"({"kind":"probes","groups":[{"bundled":false,"textures":[{"name":"color",)"
      R"("format":"A2B10G10R10_UNORM_PACK32","record_bytes":4,"grid":[2,1,1],"block":[8,8,1],)"
      R"("guard_band":1,"space":"grid","presence":"all","model":"stacked",)"
      R"("tiling":"atlas_xy_z"}]}]})");
}

}  // namespace
}  // namespace gicodec
