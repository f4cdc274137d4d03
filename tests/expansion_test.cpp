// Packets of incompressible texels: never larger than docs/guarantees.md says ("Size of a packet").
#include "container_support.h"

#include "texture/guard_band.h"

#include <gtest/gtest.h>

#include <numeric>

namespace gicodec {
namespace {

using namespace test;

/// The page's formula for an update of `probes` probes, `rings` of them with a ring of their own.
std::size_t documented_bound(const TextureDesc& desc, std::string_view backend, std::size_t probes,
                             std::size_t rings) {
  const std::size_t texels = probes * core_bytes(desc);
  std::size_t payload = 0;
  if (backend == "raw") payload = 1 + texels;
  if (backend == "lz4") payload = 17 + texels + texels / 255;
  if (backend == "zstd") payload = 65 + texels + texels / 256;
  if (backend == "native") payload = 10 + texels + 6 * probes;
  const std::size_t index = (probe_count(desc) + 7) / 8;
  const std::size_t borders = rings == 0 ? 0 : 12 + (probes + 7) / 8 + rings * ring_bytes(desc);
  return 51 + index + borders + payload;
}

std::vector<TextureDesc> shapes() {
  std::vector<TextureDesc> all;
  constexpr std::uint16_t kSides[] = {1, 2, 3, 7, 8, 16, 17, 64};
  constexpr Grid kGrids[] = {{1, 1, 1}, {3, 5, 1}, {5, 4, 3}};
  for (const auto& info : formats()) {
    for (int of_each = 0; of_each < 3; ++of_each) {
      const std::uint16_t side = kSides[all.size() % std::size(kSides)];
      const Grid grid = kGrids[side >= 16 ? all.size() % 2 : all.size() % 3];
      const auto border = static_cast<std::uint16_t>(all.size() / 3 % 2);
      all.push_back({info.format, side == 64 ? Grid{1, 1, 1} : grid, side, border, {}});
    }
  }
  all.push_back({Format::R16_SFLOAT, {40, 40, 2}, 1, 0, {}});
  all.push_back({Format::R16_SFLOAT, {300, 1, 5}, 1, 1, {}});
  return all;
}

constexpr Coding kCodings[] = {{"raw", 0, true},
                               {"raw", 0, false},
                               {"lz4", 1, true},
                               {"lz4", 12, true},
                               {"zstd", 1, true},
                               {"zstd", 5, false},
                               {"native", 0, true, "fast"},
                               {"native", 0, true, "strong"}};

TEST(Expansion, NoiseOfEveryFormatAndShapeKeepsToTheBound) {
  Random random(71);
  for (const auto& desc : shapes()) {
    const auto total = probe_count(desc);
    std::vector<std::uint32_t> some;
    for (std::uint32_t probe = 0; probe < total; probe += 3) some.push_back(probe);
    for (const auto& coding : kCodings) {
      if (coding.preset == std::string_view("strong") && desc.core > 3) continue;  // It takes long.
      Texture texture(desc);
      auto encoder = *Encoder::create(desc, options_of(coding));
      for (int frame = 0; frame < 3; ++frame) {
        // Guard bands of noise first, by the rule later.
        for (std::uint32_t probe = 0; probe < total; ++probe) {
          texture.set_block(probe, noise(random, texture.block(probe).size()));
          if (frame > 0) texture.fill_border(probe);
        }
        const bool all = frame < 2;
        const auto packet = *encoder.encode(std::as_const(texture).view(),
                                            all ? Selection::all() : Selection(some));
        const std::size_t probes = all ? total : some.size();
        const std::size_t rings = frame == 0 && desc.border == 1 ? probes : 0;
        // A ring of one texel's neighbours may follow the rule by chance; none is lost by that.
        EXPECT_LE(packet.size(), documented_bound(desc, coding.backend, probes, rings))
            << desc << " " << coding.backend << " frame " << frame;
      }
    }
  }
}

TEST(Expansion, TheEncodersBoundIsThePagesFormula) {
  for (const auto& desc : shapes()) {
    for (const auto& coding : kCodings) {
      const auto encoder = *Encoder::create(desc, options_of(coding));
      for (const std::size_t probes :
           {std::size_t{0}, std::size_t{1}, std::size_t{probe_count(desc)}}) {
        EXPECT_LE(encoder.bound(probes),
                  documented_bound(desc, coding.backend, probes, probes == 0 ? 1 : probes))
            << desc << " " << coding.backend;
      }
    }
  }
}

TEST(Expansion, ContainersAddLittle) {
  const TextureDesc desc{Format::R16_SFLOAT, {2, 1, 1}, 1, 0, Tiling::atlas_xy_z};
  const Texture texture(desc);
  auto encoder = *Encoder::create(desc, {.backend = "raw"});
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, {{{"texture", desc, {}}}, {}});
  constexpr std::uint64_t kPackets = 200;
  for (std::uint64_t i = 0; i < kPackets; ++i) {
    const auto packet = *encoder.encode(texture.view());
    const std::uint64_t before = writer.bytes_written();
    ASSERT_EQ(writer.add(i * (UINT64_MAX / kPackets), packet), Status::ok);
    EXPECT_LE(writer.bytes_written() - before, packet.size() + 25);
  }
  const std::uint64_t before = writer.bytes_written();
  ASSERT_EQ(writer.finish(), Status::ok);
  EXPECT_LE(writer.bytes_written() - before, 22 * kPackets + 39);
}

}  // namespace
}  // namespace gicodec
