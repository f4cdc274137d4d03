// The reference decoder, written from docs/native.md alone, reads every native golden file.
#include "bitstream/index_buffer.h"
#include "bitstream/packet.h"
#include "golden/map_golden.h"
#include "native/frame/chunk_head.h"
#include "native/frame/payload.h"
#include "native/matches/match_chunk.h"
#include "native/reference_decoder.h"
#include "native/rows/row_chunk.h"
#include "native/tokens/token_head.h"

#include <gicodec/container.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <set>

namespace gicodec {
namespace {

using test::Bytes;

/// Records of every block, without guard bands.
Bytes records_of(test::Texture& texture) {
  const auto& desc = texture.desc();
  if (desc.guard_band == 0) return texture.blocks();
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

/// How a chunk is coded, by its first byte.
enum class ChunkKind { raw, modelled, adaptive, rows, matches, tokens };
ChunkKind kind_of(std::byte first) {
  switch (std::to_integer<std::uint8_t>(first)) {
    case native::kRawChunk:
      return ChunkKind::raw;
    case native::kAdaptiveChunk:
      return ChunkKind::adaptive;
    case native::kRowChunk:
      return ChunkKind::rows;
    case native::kMatchChunk:
      return ChunkKind::matches;
    default:
      return (std::to_integer<unsigned>(first) & 3) == native::kTokenChunk ? ChunkKind::tokens
                                                                           : ChunkKind::modelled;
  }
}

/// A chunk of a texture in a keyframe or an update.
struct Coded {
  std::string texture;
  bool keyframe;
  ChunkKind kind;
  friend auto operator<=>(const Coded&, const Coded&) = default;
};
std::set<Coded> chunks_of(const std::string& name) {
  std::ifstream file(std::string(GICODEC_GOLDEN_DIR "/") + name, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  MemorySource source(std::as_bytes(std::span(text)));
  auto reader = *ContainerReader::open(source);
  std::set<Coded> all;
  ContainerPacket packet;
  while (reader.next(packet) == Status::ok) {
    const TextureEntry& texture = reader.description().textures[packet.texture_id];
    const auto parts = *parse_packet(packet.bytes);
    const std::size_t blocks =
        parts.info.all_blocks ? block_count(texture.desc) : parts.info.blocks;
    native::PayloadMemory memory;
    EXPECT_EQ(native::check_payload(texture.desc, blocks, parts.payload, memory), Status::ok);
    for (const auto chunk : memory.head.chunks)
      all.insert({texture.name, packet.keyframe, kind_of(chunk.front())});
  }
  return all;
}

/// The golden files stand for all that native writes.
TEST(NativeGoldenChunks, EveryKindIsThere) {
  const auto fast = chunks_of("maps_fast.gic"), strong = chunks_of("maps_strong.gic");
  for (const bool keyframe : {true, false}) {
    for (const char* texture : {"halves", "packed", "shared", "floats", "precise"}) {
      EXPECT_TRUE(fast.contains({texture, keyframe, ChunkKind::rows})) << texture << keyframe;
      // Of floats whose low halves are noise, rows are smaller.
      EXPECT_TRUE(strong.contains({texture, keyframe, ChunkKind::adaptive}) ||
                  texture == std::string("precise"))
          << texture << keyframe;
    }
    EXPECT_TRUE(strong.contains({"repeated", keyframe, ChunkKind::matches})) << keyframe;
    EXPECT_TRUE(chunks_of("native_fast.gic").contains({"colour", keyframe, ChunkKind::modelled}));
    EXPECT_TRUE(chunks_of("native_turbo.gic").contains({"colour", keyframe, ChunkKind::tokens}));
  }
}

INSTANTIATE_TEST_SUITE_P(Files, NativeGolden,
                         testing::Values(Files{"sequence_native.gic", golden::paint, 10},
                                         Files{"native_fast.gic", golden::paint_native, 1},
                                         Files{"native_strong.gic", golden::paint_native, 1},
                                         Files{"native_turbo.gic", golden::paint_native, 1},
                                         Files{"maps_fast.gic", golden::paint_map, 1},
                                         Files{"maps_strong.gic", golden::paint_map, 1}),
                         [](const auto& test) {
                           return test.param.name.substr(0, test.param.name.find('.'));
                         });

}  // namespace
}  // namespace gicodec
