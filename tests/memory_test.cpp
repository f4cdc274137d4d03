// What sessions hold on the heap: never more than docs/guarantees.md says ("Memory"), also when a
// decoder is given forged packets.
#include "allocation_counter.h"
#include "support.h"

#include "texture/guard_band.h"

#include <gtest/gtest.h>

namespace gicodec {
namespace {

using namespace test;

constexpr std::size_t kKiB = 1024, kMiB = 1024 * kKiB;

/// The page's formulas, for the texture `of` and a number of threads per packet.
struct Bounds {
  const TextureDesc& of;
  unsigned threads = 1;

  [[nodiscard]] std::size_t cores() const { return probe_count(of) * core_bytes(of); }
  [[nodiscard]] std::size_t texture() const {
    return probe_count(of) * (core_bytes(of) + ring_bytes(of));
  }
  [[nodiscard]] std::size_t native() const {
    return threads * (4 * texture() + 1280 * core_bytes(of) + 2 * kMiB);
  }
  [[nodiscard]] std::size_t encoder(std::string_view backend) const {
    const std::size_t base = 9 * texture() + 512 * probe_count(of) + 2 * kMiB;
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

const TextureDesc kShapes[] = {{Format::R8G8B8A8_UNORM, {1, 1, 1}, 1, 0, {}},
                               {Format::R16_SFLOAT, {16, 16, 8}, 1, 1, {}},
                               {Format::R16G16_SFLOAT, {3, 1, 1}, 64, 1, {}},
                               {Format::A2B10G10R10_UNORM_PACK32, {9, 8, 9}, 4, 1, {}},
                               {Format::R32G32B32A32_SFLOAT, {5, 3, 2}, 9, 0, {}}};

/// Noise with stale guard bands twice, then little texels with sound ones in half of the probes.
std::vector<std::unique_ptr<Texture>> frames_of(const TextureDesc& desc) {
  Random random(81);
  std::vector<std::unique_ptr<Texture>> frames;
  for (int frame = 0; frame < 4; ++frame) {
    auto& texture = *frames.emplace_back(std::make_unique<Texture>(desc));
    for (std::uint32_t probe = 0; probe < probe_count(desc); ++probe) {
      texture.set_block(probe, noise(random, texture.block(probe).size()));
      if (frame < 2) continue;
      if (probe % 2 == 0) texture.fill_core(probe, Fill::small, random);
      texture.fill_border(probe);
    }
  }
  return frames;
}

std::vector<Packet> expect_encoder_within_bound(const TextureDesc& desc, const Coding& coding,
                                                unsigned threads = 1) {
  const auto frames = frames_of(desc);
  auto options = options_of(coding);
  options.settings.threads = threads;
  std::vector<Packet> packets(frames.size() + 1);
  const std::size_t peak = heap_peak_of([&] {
    auto encoder = *Encoder::create(desc, options);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      packets[i] = *encoder.encode(std::as_const(*frames[i]).view());
    }
    packets.back() = *encoder.snapshot();
  });
  std::size_t size = 0;
  for (const auto& packet : packets) size += packet.capacity();
  const Bounds bounds{desc, threads};
  EXPECT_LE(peak - size, bounds.encoder(coding.backend))
      << desc << " " << coding.backend << " level " << coding.level;
  return packets;
}

void expect_decoder_within_bound(const TextureDesc& desc, std::span<const Packet> packets,
                                 unsigned threads = 1) {
  Texture out(desc);
  DecoderOptions options;
  options.threads = threads;
  std::size_t largest = 0;
  for (const auto& packet : packets) largest = std::max(largest, packet.size());
  const std::size_t peak = heap_peak_of([&] {
    auto decoder = *Decoder::create(desc, options);
    for (const auto& packet : packets) (void)decoder.decode(packet, out.view());
  });
  EXPECT_LE(peak, (Bounds{desc, threads}.decoder() + largest)) << desc;
}

TEST(Memory, SessionsKeepToTheBound) {
  for (const auto& desc : kShapes) {
    for (const auto& coding : kCodings) {
      expect_decoder_within_bound(desc, expect_encoder_within_bound(desc, coding));
    }
  }
}

TEST(Memory, ThreadsTakeTheirShareEach) {
  const TextureDesc desc{Format::A2B10G10R10_UNORM_PACK32, {16, 16, 10}, 3, 1, {}};
  for (const unsigned threads : {2U, 5U}) {
    const auto packets = expect_encoder_within_bound(desc, {"native", 0, true}, threads);
    expect_decoder_within_bound(desc, packets, threads);
  }
}

TEST(Memory, ForgedPacketsTakeNoMore) {
  Random random(82);
  const TextureDesc desc{Format::R16G16_SFLOAT, {4, 3, 2}, 4, 1, {}};
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

TEST(Memory, WritingAViewAllocatesNothing) {
  for (const auto& desc : kShapes) {
    const auto packets = expect_encoder_within_bound(desc, {"raw", 0, true});
    auto decoder = *Decoder::create(desc);
    ASSERT_EQ(decoder.decode(packets[0]), Status::ok);
    Texture out(desc);
    const auto view = out.view();
    auto status = Status::corrupt;
    EXPECT_EQ(heap_peak_of([&] { status = decoder.read(view); }), 0U);
    EXPECT_EQ(status, Status::ok);
    EXPECT_EQ(heap_peak_of([&] { status = decoder.read(view, decoder.updated()); }), 0U);
    EXPECT_EQ(status, Status::ok);
  }
}

TEST(Memory, ContainersTakeLittle) {
  class Counting final : public Sink {
   public:
    explicit Counting(Bytes& file) : file_(file) {}
    Status write(std::span<const std::byte> bytes) override {
      std::ranges::copy(bytes, file_.begin() + static_cast<std::ptrdiff_t>(size));
      size += bytes.size();
      return Status::ok;
    }
    std::size_t size = 0;

   private:
    Bytes& file_;
  };
  Random random(83);
  const TextureDesc desc{Format::R32_SFLOAT, {16, 16, 2}, 16, 0, {}};
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  auto encoder = *Encoder::create(desc, {.backend = "raw", .gop = 4});
  std::vector<Packet> packets;
  std::size_t largest = 0;
  for (int i = 0; i < 500; ++i) {
    if (i % 100 == 7) texture.fill(Fill::noise, random);
    packets.push_back(*encoder.encode(std::as_const(texture).view()));
    largest = std::max(largest, packets.back().size());
  }
  Bytes file(packets.size() * (largest + 100));
  Counting sink(file);
  const std::size_t writing = heap_peak_of([&] {
    auto writer = *ContainerWriter::create(sink, {{{"texture", desc, {}}}, {}});
    for (std::size_t i = 0; i < packets.size(); ++i) {
      if (writer.add(i, packets[i]) != Status::ok) std::abort();
    }
    if (writer.finish() != Status::ok) std::abort();
  });
  EXPECT_LE(writing, 2 * largest + 72 * packets.size() + kKiB);
  std::size_t count = 0;
  const std::size_t reading = heap_peak_of([&] {
    const auto written = std::span(file).first(sink.size);
    MemorySource source(written);
    auto reader = *ContainerReader::open(source);
    for (ContainerPacket packet; reader.next(packet) == Status::ok;) ++count;
  });
  EXPECT_EQ(count, packets.size());
  EXPECT_LE(reading, 5 * (largest + 25) + 72 * packets.size() + kKiB);
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
