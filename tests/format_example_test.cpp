// The worked example of FORMAT.md, read from the page itself.
#include <gicodec/gicodec.h>
#include <gicodec/probes.h>

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace gicodec {
namespace {

std::vector<std::byte> example_bytes() {
  std::ifstream page(GICODEC_FORMAT_PAGE);
  std::vector<std::byte> bytes;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line == "```hex") {
      inside = true;
    } else if (line == "```") {
      inside = false;
    } else if (inside) {
      std::istringstream words(line);
      for (unsigned byte; words >> std::hex >> byte;) bytes.push_back(static_cast<std::byte>(byte));
    }
  }
  return bytes;
}

TEST(FormatPage, ExampleDecodesToWhatItSays) {
  const auto bytes = example_bytes();
  ASSERT_EQ(bytes.size(), 192U);
  MemorySource source(bytes);
  auto reader = ContainerReader::open(source);
  ASSERT_TRUE(reader.ok());
  EXPECT_TRUE(reader->seekable());
  EXPECT_TRUE(reader->finished());
  ASSERT_EQ(reader->description().volumes.size(), 1U);
  EXPECT_EQ(reader->description().volumes[0].kind, kKindProbes);
  ASSERT_EQ(reader->description().textures.size(), 1U);
  const auto& texture = reader->description().textures[0];
  EXPECT_EQ(texture.name, "vis");
  EXPECT_EQ(texture.desc, probe_texture(Format::R16G16_SFLOAT, {3, 1, 1}, 1, 0));

  auto decoder = Decoder::create(texture.desc);
  ASSERT_TRUE(decoder.ok());
  std::array<std::uint32_t, 3> texels{};
  const TextureView view{std::as_writable_bytes(std::span(texels))};
  ContainerPacket packet;
  ASSERT_EQ(reader->next(packet), Status::ok);
  ASSERT_EQ(decoder->decode(packet.bytes, view), Status::ok);
  EXPECT_EQ(texels, (std::array<std::uint32_t, 3>{0x44003C00, 0, 0x44003C00}));
  ASSERT_EQ(reader->next(packet), Status::ok);
  ASSERT_EQ(decoder->decode(packet.bytes, view), Status::ok);
  EXPECT_EQ(texels, (std::array<std::uint32_t, 3>{0x44003C00, 0, 0x44013C02}));
  EXPECT_EQ(packet.frame, 1U);
  EXPECT_EQ(reader->next(packet), Status::end);
}

}  // namespace
}  // namespace gicodec
