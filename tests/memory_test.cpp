// What sessions hold on the heap: never more than docs/guarantees.md says ("Memory"), also when a
// decoder is given forged packets.
#include "allocation_counter.h"
#include "container_support.h"
#include "shapes.h"
#include "support.h"

#include <gicodec/player.h>

#include "texture/guard_band.h"

#include <gtest/gtest.h>

namespace gicodec {
namespace {

using namespace test;

/// The page's formulas, for the texture `of` and a number of threads per packet.
struct Bounds {
  const TextureDesc& of;
  unsigned threads = 1;

  [[nodiscard]] std::size_t cores() const { return block_count(of) * block_bytes(of); }
  [[nodiscard]] std::size_t texture() const {
    return block_count(of) * (block_bytes(of) + band_bytes(of) + presence_bytes(of));
  }
  [[nodiscard]] std::size_t native() const {
    std::size_t words = 0;
    for (const auto& component : of.record.used()) words += component.bits > 16 ? 4 : 2;
    words *= record_count(of.block);
    const bool pairs = of.record.format == Format::R16G16_SFLOAT && of.presence == Presence::all;
    const bool shared = of.record.format == Format::E5B9G9R9_UFLOAT_PACK32;
    const std::size_t lanes = pairs ? 1280 : shared ? 432 : 384;
    const std::size_t block = record_count(of.block) * std::size_t{of.record.count};
    const std::size_t values = std::min(std::max(kMiB, block), block * block_count(of));
    const std::size_t rows = (of.grid.x * std::size_t{of.block.x} + 72) *
                             ((of.grid.y * std::size_t{of.block.y} + 31) / 32 * 32) * of.grid.z *
                             of.block.z * of.record.count;
    const std::size_t rasters =
        of.model == Model::continuous ? 40 * values + 32 * std::min(kMiB, rows) + kMiB : 0;
    return threads * ((4 * block_count(of) + lanes) * words + 2 * kMiB + rasters);
  }
  [[nodiscard]] std::size_t encoder(std::string_view backend, bool lossy) const {
    const std::size_t textures = lossy ? 11 : 9;
    const std::size_t base = textures * texture() + 512 * block_count(of) + 2 * kMiB;
    if (backend == "lz4") return base + 512 * kKiB;
    if (backend == "zstd") return base + 33 * cores() + 3 * kMiB;
    return backend == "native" ? base + native() : base;
  }
  /// For any packets.
  [[nodiscard]] std::size_t decoder() const { return decoder_memory(of, threads); }
};

constexpr Coding kCodings[] = {
    {"raw", 0, true},   {"lz4", 12, true},           {"zstd", 0, true},
    {"zstd", 22, true}, {"native", 0, true, "fast"}, {"native", 0, true, "strong"}};

/// Slots of which not every record exists.
TextureDesc partial(Presence presence, const Record& record, BlockShape block,
                    std::uint32_t slots) {
  TextureDesc desc = pool_texture(record, slots, block);
  desc.presence = presence;
  return desc;
}

TextureDesc map(const Record& record, Grid grid, BlockShape block) {
  TextureDesc desc = probe_texture(record, grid, block.x, 0);
  desc.block = block;
  desc.model = Model::continuous;
  return desc;
}

const TextureDesc kShapes[] = {bricks(),
                               map(Format::R16G16B16A16_SFLOAT, {24, 20, 1}, {8, 8, 1}),
                               map(Format::R32_SFLOAT, {4, 4, 4}, {16, 16, 2}),
                               map(Format::E5B9G9R9_UFLOAT_PACK32, {1, 1, 2}, {64, 64, 8}),
                               partial(Presence::mask, Format::R8G8B8_SNORM, {8, 8, 8}, 400),
                               partial(Presence::mask, Format::R8_UINT, {1, 1, 1}, 5000),
                               partial(Presence::count, Format::R16_UNORM, {64, 8, 1}, 300),
                               probe_texture(Format::R8G8B8A8_UNORM, {1, 1, 1}, 1, 0),
                               probe_texture(Format::R16_SFLOAT, {16, 16, 8}, 1, 1),
                               probe_texture(Format::R16G16_SFLOAT, {3, 1, 1}, 64, 1),
                               probe_texture(Format::A2B10G10R10_UNORM_PACK32, {9, 8, 9}, 4, 1),
                               probe_texture(Format::E5B9G9R9_UFLOAT_PACK32, {6, 4, 6}, 8, 1),
                               probe_texture(Format::R32G32B32A32_SFLOAT, {5, 3, 2}, 9, 0)};

/// Noise with stale guard bands twice, then little records with sound ones in half of the blocks.
std::vector<std::unique_ptr<Texture>> frames_of(const TextureDesc& desc) {
  Random random(81);
  std::vector<std::unique_ptr<Texture>> frames;
  for (int frame = 0; frame < 4; ++frame) {
    auto& texture = *frames.emplace_back(std::make_unique<Texture>(desc));
    for (std::uint32_t block = 0; block < block_count(desc); ++block) {
      texture.set_block(block, noise(random, texture.block(block).size()));
      if (frame < 2) continue;
      if (block % 2 == 0) texture.fill_block(block, Fill::small, random);
      texture.fill_band(block);
    }
  }
  return frames;
}

std::vector<Packet> expect_encoder_within_bound(const TextureDesc& desc, const Coding& coding,
                                                unsigned threads = 1, float max_error = 0) {
  const auto frames = frames_of(desc);
  auto options = options_of(coding);
  options.max_error = max_error;
  options.settings.threads = threads;
  std::vector<Packet> packets(frames.size() + 1);
  const Bytes presence = full_presence(desc);
  const std::size_t peak = heap_peak_of([&] {
    auto encoder = *Encoder::create(desc, options);
    (void)encoder.set_presence(presence);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      packets[i] = *encoder.encode(std::as_const(*frames[i]).view());
    }
    packets.back() = *encoder.snapshot();
  });
  std::size_t size = 0;
  for (const auto& packet : packets) size += packet.capacity();
  const Bounds bounds{desc, threads};
  EXPECT_LE(peak - size, bounds.encoder(coding.backend, max_error > 0))
      << desc << " " << coding.backend << " level " << coding.level;
  return packets;
}

void expect_decoder_within_bound(const TextureDesc& desc, std::span<const Packet> packets,
                                 unsigned threads = 1) {
  Texture out(desc);
  const Bytes presence = full_presence(desc);
  DecoderOptions options;
  options.threads = threads;
  std::size_t largest = 0;
  for (const auto& packet : packets) largest = std::max(largest, packet.size());
  const std::size_t peak = heap_peak_of([&] {
    auto decoder = *Decoder::create(desc, options);
    (void)decoder.set_presence(presence);
    for (const auto& packet : packets) (void)decoder.decode(packet, out.view());
  });
  EXPECT_LE(peak, (Bounds{desc, threads}.decoder() + largest)) << desc;
}

TEST(Memory, SessionsKeepToTheBound) {
  test::Sweep sweep;
  for (const auto& desc : kShapes) {
    for (const auto& coding : kCodings) {
      if (std::string_view(coding.backend) != "native" && !sweep.takes()) continue;
      expect_decoder_within_bound(desc, expect_encoder_within_bound(desc, coding));
    }
  }
}

TEST(Memory, ChangesOfThePresetKeepToTheBound) {
  for (const auto& desc : kShapes) {
    const auto frames = frames_of(desc);
    const Bytes presence = full_presence(desc);
    std::size_t size = 0;
    const std::size_t peak = heap_peak_of([&] {
      auto encoder = *Encoder::create(desc);
      (void)encoder.set_presence(presence);
      Packet packet;
      for (const char* preset : {"turbo", "strong", "fast"}) {
        (void)encoder.set_preset(preset);
        for (const auto& frame : std::span(frames).first(2)) {
          (void)encoder.encode_to(std::as_const(*frame).view(), Selection::all(), packet);
          size = std::max(size, packet.capacity());
        }
      }
    });
    EXPECT_GT(size, 0U);
    EXPECT_LE(peak - size, (Bounds{desc}.encoder("native", false))) << desc;
  }
}

TEST(Memory, ABoundTakesTwoTexturesMore) {
  const TextureDesc desc = partial(Presence::mask, Format::R8G8B8A8_UNORM, {16, 16, 8}, 300);
  for (const char* backend : {"raw", "native", "zstd"}) {
    expect_encoder_within_bound(desc, {backend, 0, true}, 1, 3);
  }
}

/// Enough of both that neither hides behind what every session takes.
TEST(Memory, WhatDoesNotExistIsCountedToo) {
  for (const auto& desc : {partial(Presence::mask, Format::R8G8B8_SNORM, {8, 8, 8}, 2000),
                           partial(Presence::mask, Format::R8_UINT, {64, 64, 8}, 130)}) {
    for (const Coding& coding : {Coding{"zstd", 1, true}, Coding{"native", 0, true}}) {
      expect_decoder_within_bound(desc, expect_encoder_within_bound(desc, coding));
    }
  }
}

TEST(Memory, ThreadsTakeTheirShareEach) {
  const TextureDesc desc = probe_texture(Format::A2B10G10R10_UNORM_PACK32, {16, 16, 10}, 3, 1);
  for (const unsigned threads : {2U, 5U}) {
    const auto packets = expect_encoder_within_bound(desc, {"native", 0, true}, threads);
    expect_decoder_within_bound(desc, packets, threads);
  }
  // Three chunks of rows, and of what learns.
  const TextureDesc rows = map(Format::R8_UNORM, {96, 48, 1}, {8, 8, 1});
  for (const char* preset : {"fast", "strong"}) {
    const auto packets = expect_encoder_within_bound(rows, {"native", 0, true, preset}, 3);
    expect_decoder_within_bound(rows, packets, 3);
  }
}

TEST(Memory, ForgedPacketsTakeNoMore) {
  Random random(82);
  const TextureDesc desc = probe_texture(Format::R16G16_SFLOAT, {4, 3, 2}, 4, 1);
  for (const auto& coding : kCodings) {
    const auto packets = expect_encoder_within_bound(desc, coding);
    for (int round = 0; round < 200; ++round) {
      // Mostly in the head, where sizes and counts stand.
      auto forged = packets[random() % 3];
      for (int i = 0; i < 2; ++i) {
        const std::size_t most = chance(random, 3) ? forged.size() - 4 : 40;
        forged[random() % std::min(most, forged.size() - 4)] = static_cast<std::byte>(random());
      }
      reseal(forged);
      expect_decoder_within_bound(desc, std::vector{packets[0], forged});
    }
  }
}

// Also where thousands of regions hold a block each.
TEST(Memory, APlayerSaysWhatItTakes) {
  for (const Grid region : {Grid{1, 1, 1}, Grid{3, 2, 1}, Grid{}}) {
    const TextureDesc desc = probe_texture(Format::B10G11R11_UFLOAT_PACK32, {30, 20, 9}, 2, 1);
    ContainerDescription description = probe_description(std::vector<ProbeTexture>{{"t", desc}});
    description.volumes[0].region = region;
    MemorySink sink;
    auto writer = *ContainerWriter::create(sink, description);
    const bool whole = region == Grid{};
    const std::uint32_t regions = whole ? 1 : regions_of(desc, region).regions();
    for (std::uint32_t i = 0; i < regions; ++i) {
      const TextureDesc part = whole ? desc : region_texture(desc, region, i);
      auto encoder = *Encoder::create(part, {});
      const Bytes texels(static_cast<std::size_t>(texture_bytes(part)));
      ASSERT_EQ(writer.add(0, *encoder.encode(ConstTextureView(texels)),
                           whole ? StreamId::kWholeVolume : i),
                Status::ok);
    }
    ASSERT_EQ(writer.finish(), Status::ok);
    MemorySource source(sink.bytes);
    auto player = *ContainerPlayer::open(source);
    ASSERT_EQ(player.skip(), Status::ok);  // Its packets are held now.
    ASSERT_EQ(player.seek(0), Status::ok);
    const std::size_t peak = heap_peak_of([&] { EXPECT_EQ(player.next(), Status::ok); });
    EXPECT_LE(peak, player.memory()) << region.x;
  }
}

TEST(Memory, WritingAViewAllocatesNothing) {
  for (const auto& desc : kShapes) {
    const auto packets = expect_encoder_within_bound(desc, {"raw", 0, true});
    auto decoder = *Decoder::create(desc);
    const Bytes presence = full_presence(desc);
    ASSERT_EQ(decoder.set_presence(presence), Status::ok);
    ASSERT_EQ(decoder.decode(packets[0]), Status::ok);
    Texture out(desc);
    const auto view = out.view();
    auto status = Status::corrupt;
    EXPECT_EQ(heap_peak_of([&] { status = decoder.read(view); }), 0U);
    EXPECT_EQ(status, Status::ok);
    EXPECT_EQ(heap_peak_of([&] { status = decoder.read(view, decoder.changed()); }), 0U);
    EXPECT_EQ(status, Status::ok);
  }
}

TEST(Memory, TheCounterCounts) {
  EXPECT_EQ(heap_peak_of([] {}), 0U);
  EXPECT_GE(heap_peak_of([] {
              std::vector<char> some(100000);
              some[5] = 1;
              EXPECT_EQ(some[5], 1);
            }),
            100000U);
}

}  // namespace
}  // namespace gicodec
