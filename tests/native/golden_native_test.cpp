// The reference decoder, written from docs/native.md alone, reads every native golden file.
#include "bitstream/index_buffer.h"
#include "bitstream/packet.h"
#include "golden/native_golden.h"
#include "native/reference_decoder.h"

#include <gicodec/container.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>

namespace gicodec {
namespace {

using test::Bytes;

/// Records of every block, without guard bands.
Bytes records_of(test::Texture& texture) {
  const auto& desc = texture.desc();
  Bytes records;
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    for (std::uint32_t y = 0; y < desc.block.y; ++y) {
      for (std::uint32_t x = 0; x < desc.block.x; ++x) {
        const auto record = texture.record(block, x + desc.guard_band, y + desc.guard_band);
        records.insert(records.end(), record.begin(), record.end());
      }
    }
  }
  return records;
}

struct Files {
  std::string name;
  void (*paint)(test::Texture&, std::uint32_t frame);
  std::uint32_t frame_step;  ///< frame numbers in the container per painted frame
};
class NativeGolden : public testing::TestWithParam<Files> {};

TEST_P(NativeGolden, ReferenceDecoderReadsIt) {
  std::ifstream file(std::string(GICODEC_GOLDEN_DIR "/") + GetParam().name, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  MemorySource source(std::as_bytes(std::span(text)));
  auto reader = ContainerReader::open(source);
  ASSERT_TRUE(reader.ok()) << reader.status();
  const auto& textures = reader->description().textures;
  std::vector<Bytes> mirrors(textures.size());
  std::vector<std::vector<std::uint8_t>> received(textures.size());
  ContainerPacket packet;
  std::size_t packets = 0;
  for (; reader->next(packet) == Status::ok; ++packets) {
    const auto& desc = textures[packet.texture_id].desc;
    const std::size_t size = block_bytes(desc);
    const auto parts = parse_packet(packet.bytes);
    ASSERT_TRUE(parts.ok());
    ASSERT_EQ(parts->info.backend, kBackendNative);
    const bool keyframe = is_keyframe(parts->info.type);
    Vector<std::uint32_t> blocks;
    const auto count = parts->info.all_blocks ? block_count(desc) : parts->info.blocks;
    ASSERT_EQ(
        decode_index_buffer(parts->index_mode, count, block_count(desc), parts->index, blocks),
        Status::ok);
    Bytes& mirror = mirrors[packet.texture_id];
    auto& known = received[packet.texture_id];
    const auto records = keyframe ? reference::decode(desc, blocks, {}, {}, parts->payload)
                                  : reference::decode(desc, blocks, mirror, known, parts->payload);
    ASSERT_TRUE(records.has_value()) << packet.frame << " " << desc;
    if (keyframe) {
      mirror.assign(block_count(desc) * size, std::byte{0});
      known.assign(block_count(desc), 0);
    }
    test::Texture painted(desc);
    GetParam().paint(painted, static_cast<std::uint32_t>(packet.frame) / GetParam().frame_step);
    const Bytes expected = records_of(painted);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const std::size_t at = blocks[i] * size;
      EXPECT_EQ(std::memcmp(records->data() + i * size, expected.data() + at, size), 0)
          << "frame " << packet.frame << " " << desc << " block " << blocks[i];
      std::memcpy(mirror.data() + at, records->data() + i * size, size);
      known[blocks[i]] = 1;
    }
  }
  EXPECT_EQ(packets % textures.size(), 0U);
  EXPECT_GE(packets, 3 * textures.size());
}

INSTANTIATE_TEST_SUITE_P(Files, NativeGolden,
                         testing::Values(Files{"sequence_native.gic", golden::paint, 10},
                                         Files{"native_fast.gic", golden::paint_native, 1},
                                         Files{"native_strong.gic", golden::paint_native, 1},
                                         Files{"native_turbo.gic", golden::paint_native, 1}),
                         [](const auto& test) {
                           return test.param.name.substr(0, test.param.name.find('.'));
                         });

}  // namespace
}  // namespace gicodec
