// What hostile packets cost: whoever is refused by what his head, index, sizes or tables say has
// cost next to nothing, however large the texture is; limits hold; work can be cancelled.
#include "allocation_counter.h"
#include "support.h"

#include "base/bytes.h"
#include "bitstream/description.h"
#include "bitstream/index_buffer.h"
#include "bitstream/packet.h"
#include "texture/guard_band.h"

#include <gicodec/decoder.h>
#include <gicodec/encoder.h>

#include <gtest/gtest.h>

#include <atomic>
#include <functional>

namespace gicodec {
namespace {

using namespace test;

const TextureDesc kLarge = probe_texture(Format::R16G16_SFLOAT, {64, 64, 64}, 4, 1);
/// Contexts of zstd, and what LZ4 and containers of the standard library have before their first
/// use: not in proportion to anything.
constexpr std::size_t kFixed = 200 * 1024;

struct Crafted {
  std::uint8_t backend = kBackendNative;
  IndexMode mode = IndexMode::all;
  std::uint32_t blocks = 0;
  Bytes index = {}, guard_bands = {}, payload = {};
};

Packet keyframe_of(const Crafted& crafted) {
  PacketHead head =
      PacketChain{crafted.backend}.next(description_hash(kLarge), PacketType::keyframe);
  head.index_mode = crafted.mode;
  head.info.blocks = crafted.blocks;
  Packet packet;
  write_packet_head(head, crafted.index, crafted.guard_bands, packet);
  packet.insert(packet.end(), crafted.payload.begin(), crafted.payload.end());
  seal_packet(packet);
  return packet;
}

Bytes bytes(std::initializer_list<int> values) {
  Bytes out;
  for (const int value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}

void expect_cheap_refusal(const Packet& packet, Status status) {
  auto decoder = *Decoder::create(kLarge);
  Status found = Status::ok;
  const std::size_t peak = heap_peak_of([&] { found = decoder.decode(packet); });
  EXPECT_EQ(found, status);
  EXPECT_LE(peak, 2 * packet.size() + kFixed);
  EXPECT_EQ(decoder.sequence(), 0U);
}

TEST(Cost, OfRefusedNativePayloads) {
  const auto refuse = [](const Bytes& payload, Status status) {
    expect_cheap_refusal(keyframe_of({.payload = payload}), status);
  };
  const auto boxed = [](int x, std::initializer_list<int> rest, int parts = 1) {
    Bytes payload = bytes({3 | parts << 4, x, 0, 16, 0, 16, 0, 0, 0});
    const Bytes behind = bytes(rest);
    payload.insert(payload.end(), behind.begin(), behind.end());
    return payload;
  };
  refuse(boxed(1, {}), Status::truncated);                // Many chunks, and none.
  refuse(boxed(1, {1, 0}), Status::truncated);            // One.
  refuse(boxed(65, {}), Status::corrupt);                 // Larger than the grid.
  refuse(boxed(16, {0, 1, 0, 0}, 3), Status::truncated);  // 256 ends, and none.
  refuse(boxed(16, {2, 0, 0, 0, 24, 0, 0, 0, 25, 0, 0, 0}, 3), Status::corrupt);  // A chunk of 0.
  refuse(boxed(16, {2, 0, 0, 0, 25, 0, 0, 0, 40, 0, 0, 0}, 3), Status::truncated);
  refuse(bytes({4}), Status::unsupported_version);
  const auto chunks = [](const Bytes& good, const Bytes& last) {
    Bytes payload = bytes({3 | 3 << 4, 16, 0, 16, 0, 16, 0, 0, 0});
    ByteWriter writer(payload);
    writer.fixed(std::uint32_t{64});
    std::size_t end = payload.size() + std::size_t{4} * 64;
    for (int i = 0; i < 64; ++i) {
      end = (end + 3) / 4 * 4 + (i < 63 ? good : last).size();
      writer.fixed(static_cast<std::uint32_t>(end));
    }
    for (int i = 0; i < 64; ++i) {
      while (payload.size() % 4 != 0) payload.push_back(std::byte{0});
      writer.bytes(i < 63 ? good : last);
    }
    return payload;
  };
  // Sets, caps, the state of one lane, no word.
  const Bytes good = bytes({1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0});
  const auto refuse_last = [&](std::initializer_list<int> last) {
    refuse(chunks(good, bytes(last)), Status::corrupt);
  };
  refuse_last({0});                                   // Raw, no record.
  refuse_last({3, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0});     // Kind.
  refuse_last({1, 0, 0, 0, 0, 0, 0, 255, 0, 0, 0});   // State.
  refuse_last({1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 7});  // Half a word.
  refuse_last({25, 0, 0, 0, 0, 0, 0});                // 64 lanes.
  refuse_last({1, 8, 0, 0, 0, 0, 0, 0, 0, 1, 0});     // A ninth set.
  refuse_last({0x21, 0, 0, 0, 0, 0, 0, 255});         // Overrides.
  refuse_last({0x81, 0, 0, 0, 0, 0, 0, 17});          // Hits.
}

TEST(Cost, OfRefusedBytePayloads) {
  const auto refuse = [](std::uint8_t backend, const Bytes& payload, Status status) {
    expect_cheap_refusal(keyframe_of({.backend = backend, .payload = payload}), status);
  };
  const Bytes few(5000);
  for (const std::uint8_t backend : {kBackendRaw, kBackendLz4, kBackendZstd}) {
    refuse(backend, {}, Status::truncated);
    refuse(backend, bytes({4}), Status::unsupported_feature);
    refuse(backend, bytes({0}), Status::corrupt);
    refuse(backend, few, Status::corrupt);
  }
  // A frame of another size than the records'.
  const TextureDesc smaller =
      probe_texture(kLarge.record.format, {64, 64, 63}, kLarge.block.x, kLarge.guard_band);
  Texture zeros(smaller);
  const auto packet = *Encoder::create(smaller, {.backend = "zstd"})
                           ->encode(std::as_const(zeros).view(), Selection::all());
  const auto payload = parse_packet(packet)->payload;
  refuse(kBackendZstd, Bytes(payload.begin(), payload.end()), Status::corrupt);
}

TEST(Cost, OfRefusedIndicesAndBands) {
  const std::uint32_t all = block_count(kLarge);
  // A run of nearly all blocks, and a bit too many behind it.
  std::vector<std::uint32_t> most(all - 1);
  for (std::uint32_t i = 0; i < most.size(); ++i) most[i] = i;
  Bytes runs;
  ASSERT_EQ(encode_index_buffer(most, all, runs), IndexMode::runs);
  runs.push_back(std::byte{0});
  expect_cheap_refusal(keyframe_of({.mode = IndexMode::runs, .blocks = all - 1, .index = runs}),
                       Status::corrupt);
  expect_cheap_refusal(
      keyframe_of({.mode = IndexMode::gaps, .blocks = all - 1, .index = bytes({0, 0})}),
      Status::corrupt);
  expect_cheap_refusal(keyframe_of({.mode = IndexMode::bitmap, .blocks = 3, .index = Bytes(8)}),
                       Status::corrupt);
  const auto bands = [](std::initializer_list<int> head) {
    Bytes section;
    ByteWriter writer(section);
    writer.fixed(std::uint8_t{0});
    writer.varint(block_count(kLarge));
    writer.bytes(bytes(head));
    return section;
  };
  expect_cheap_refusal(keyframe_of({.guard_bands = bands({0, 0})}), Status::corrupt);
  expect_cheap_refusal(keyframe_of({.guard_bands = bands({0, 1, 1, 2, 3, 4})}), Status::truncated);
  expect_cheap_refusal(keyframe_of({.guard_bands = bands({0, 2, 1, 2, 3, 4})}),
                       Status::unsupported_feature);
}

TEST(Cost, WorkBeyondTheLimitIsRefused) {
  Texture texture(kLarge);
  Random random(9);
  texture.fill_block(7, Fill::noise, random);
  texture.fill_band(7);
  auto encoder = *Encoder::create(kLarge);
  const auto view = std::as_const(texture).view();
  const auto keyframe = *encoder.encode(view);
  const std::vector<std::uint32_t> some{1, 7};
  const auto update = *encoder.encode(view, some);
  const std::size_t block = block_bytes(kLarge) + band_bytes(kLarge);
  DecoderOptions options;
  options.limits.max_work_bytes = (block_count(kLarge) + 1) * block;
  auto decoder = *Decoder::create(kLarge, options);
  ASSERT_EQ(decoder.decode(keyframe), Status::ok);
  ASSERT_EQ(decoder.decode(update), Status::ok);
  options.limits.max_work_bytes -= 1;
  auto strict = *Decoder::create(kLarge, options);
  Status status = Status::ok;
  const std::size_t peak = heap_peak_of([&] { status = strict.decode(keyframe); });
  EXPECT_EQ(status, Status::limit_exceeded);
  EXPECT_LE(peak, 1024U);
}

TEST(Cost, MemoryBeyondTheLimitIsRefused) {
  DecoderOptions options;
  options.limits.max_total_bytes = decoder_memory(kLarge);
  EXPECT_TRUE(Decoder::create(kLarge, options).ok());
  options.limits.max_total_bytes -= 1;
  Status status = Status::ok;
  const auto peak = heap_peak_of([&] { status = Decoder::create(kLarge, options).status(); });
  EXPECT_EQ(status, Status::limit_exceeded);
  EXPECT_LE(peak, 1024U);
}

TEST(Cost, CancelledPacketsAreNotApplied) {
  const TextureDesc desc = probe_texture(Format::A2B10G10R10_UNORM_PACK32, {8, 8, 8}, 4, 1);
  Random random(10);
  Texture texture(desc), out(desc);
  texture.fill(Fill::noise, random);
  for (const Coding& coding : codings()) {
    const auto packet =
        *Encoder::create(desc, options_of(coding))->encode(std::as_const(texture).view());
    std::atomic<bool> cancel{true};
    DecoderOptions options;
    options.cancel = &cancel;
    auto decoder = *Decoder::create(desc, options);
    EXPECT_EQ(decoder.decode(packet, out.view()), Status::cancelled);
    EXPECT_EQ(decoder.sequence(), 0U);
    cancel = false;
    EXPECT_EQ(decoder.decode(packet, out.view()), Status::ok);
    EXPECT_EQ(out.blocks(), texture.blocks());
  }
}

}  // namespace
}  // namespace gicodec
