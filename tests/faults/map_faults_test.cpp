// Whatever allocation fails while maps are coded: rows, tables and counters of a chunk are made
// for the first one, and a failed call leaves nothing that a later chunk would trip over.
#include "faults.h"
#include "support.h"

#include <gicodec/decoder.h>
#include <gicodec/encoder.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace gicodec {
namespace {

using namespace test;

/// A lightmap of half floats: waves with a little noise, black in a corner.
void paint(Texture& texture, unsigned frame) {
  Random random(3);
  for (std::uint32_t block = 0; block < block_count(texture.desc()); ++block) {
    std::vector<std::byte> texels = texture.block(block);
    for (std::size_t at = 0; at < texels.size(); at += 2) {
      const double wave = std::sin(0.1 * static_cast<double>(block + at / 64 + frame));
      const auto code =
          static_cast<unsigned>(0x3000 + 0x400 * wave + static_cast<double>(random() % 4));
      const unsigned bits = block == 0 ? 0 : code;
      texels[at] = static_cast<std::byte>(bits);
      texels[at + 1] = static_cast<std::byte>(bits >> 8);
    }
    texture.set_block(block, texels);
  }
}

class MapFaults : public testing::TestWithParam<const char*> {};

TEST_P(MapFaults, GoOnAsIfNothingHadFailed) {
  TextureDesc desc = probe_texture(Format::R16G16B16A16_SFLOAT, {3, 2, 1}, 8, 0);
  desc.model = Model::continuous;
  std::array<Texture, 2> textures{Texture(desc), Texture(desc)};
  for (unsigned i = 0; i < textures.size(); ++i) paint(textures[i], i);
  const EncoderOptions options = options_of({"native", 0, true, GetParam()});
  auto sound = *Encoder::create(desc, options);
  std::vector<Packet> packets;
  for (const Texture& texture : textures)
    packets.push_back(*sound.encode(std::as_const(texture).view()));
  ASSERT_LT(packets[0].size(), textures[0].blocks().size() * 3 / 4);
  const auto nothing_happened = [](auto& session, std::size_t i) {
    return session.sequence() == i;
  };
  const std::size_t faults = with_every_fault([&](Fault& fault) {
    auto encoder = *Encoder::create(desc, options);
    auto decoder = *Decoder::create(desc);
    Texture out(desc);
    for (std::size_t i = 0; i < packets.size(); ++i) {
      auto packet = fault([&] { return encoder.encode(std::as_const(textures[i]).view()); });
      if (!packet.ok()) {
        ASSERT_EQ(packet.status(), Status::out_of_memory);
        ASSERT_TRUE(nothing_happened(encoder, i));
        packet = encoder.encode(std::as_const(textures[i]).view());
      }
      ASSERT_EQ(*packet, packets[i]);
      Status status = fault([&] { return decoder.decode(*packet, out.view()); });
      if (status != Status::ok) {
        ASSERT_EQ(status, Status::out_of_memory);
        ASSERT_TRUE(nothing_happened(decoder, i));
        status = decoder.decode(*packet, out.view());
      }
      ASSERT_EQ(status, Status::ok);
      ASSERT_EQ(out.blocks(), textures[i].blocks());
    }
  });
  EXPECT_GT(faults, 20U);
}

INSTANTIATE_TEST_SUITE_P(Presets, MapFaults, testing::Values("turbo", "fast", "strong"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace gicodec
