// Packets of incompressible records: never larger than docs/guarantees.md says ("Size of a
// packet").
#include "distinct_formats.h"
#include "shapes.h"
#include "support.h"

#include "texture/guard_band.h"

#include <gtest/gtest.h>

#include <numeric>

namespace gicodec {
namespace {

using namespace test;

/// The page's formula for an update of `blocks` blocks, `bands` of them with a band of their own.
std::size_t documented_bound(const TextureDesc& desc, std::string_view backend, std::size_t blocks,
                             std::size_t bands) {
  const std::size_t records = blocks * block_bytes(desc);
  std::size_t payload = 0;
  if (backend == "raw") payload = 1 + records;
  if (backend == "lz4") payload = 17 + records + records / 255;
  if (backend == "zstd") payload = 65 + records + records / 256;
  if (backend == "native") payload = 80 + records + 8 * blocks;
  const std::size_t index = (block_count(desc) + 7) / 8;
  const std::size_t guard_bands = bands == 0 ? 0 : 12 + (blocks + 7) / 8 + bands * band_bytes(desc);
  return 51 + index + guard_bands + payload;
}

std::vector<TextureDesc> shapes() {
  std::vector<TextureDesc> all;
  constexpr std::uint8_t kSides[] = {1, 2, 3, 7, 8, 16, 17, 64};
  constexpr Grid kGrids[] = {{1, 1, 1}, {3, 5, 1}, {5, 4, 3}};
  for (const auto& info : test::distinct_formats()) {
    for (int of_each = 0; of_each < 3; ++of_each) {
      const std::uint8_t side = kSides[all.size() % std::size(kSides)];
      const Grid grid = kGrids[side >= 16 ? all.size() % 2 : all.size() % 3];
      const auto band = static_cast<std::uint8_t>(all.size() / 3 % 2);
      all.push_back(probe_texture(info.record, side == 64 ? Grid{1, 1, 1} : grid, side, band));
    }
  }
  Random random(72);
  for (int i = 0; i < 40; ++i) all.push_back(any_desc(random, 3000));
  all.push_back(probe_texture(Format::R16_SFLOAT, {40, 40, 2}, 1, 0));
  all.push_back(probe_texture(Format::R16_SFLOAT, {300, 1, 5}, 1, 1));
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
  test::Sweep sweep;
  for (const auto& desc : shapes()) {
    const auto total = block_count(desc);
    std::vector<std::uint32_t> some;
    for (std::uint32_t block = 0; block < total; block += 3) some.push_back(block);
    for (const auto& coding : kCodings) {
      if (coding.preset == std::string_view("strong") && desc.block.x > 3)
        continue;  // It takes long.
      if (!sweep.takes()) continue;
      Texture texture(desc);
      auto created = Encoder::create(desc, options_of(coding));
      ASSERT_TRUE(created.ok()) << desc << " " << coding.backend << created.status();
      auto encoder = *std::move(created);
      ASSERT_EQ(encoder.set_presence(full_presence(desc)), Status::ok);
      for (int frame = 0; frame < 3; ++frame) {
        // Guard bands of noise first, by the rule later.
        for (std::uint32_t block = 0; block < total; ++block) {
          texture.set_block(block, noise(random, texture.block(block).size()));
          if (frame > 0) texture.fill_band(block);
        }
        const bool all = frame < 2;
        const auto packet = *encoder.encode(std::as_const(texture).view(),
                                            all ? Selection::all() : Selection(some));
        const std::size_t blocks = all ? total : some.size();
        const std::size_t bands = frame == 0 && desc.guard_band == 1 ? blocks : 0;
        // A band of one record's neighbours may follow the rule by chance; none is lost by that.
        EXPECT_LE(packet.size(), documented_bound(desc, coding.backend, blocks, bands))
            << desc << " " << coding.backend << " frame " << frame;
      }
    }
  }
}

TEST(Expansion, TheEncodersBoundIsThePagesFormula) {
  for (const auto& desc : shapes()) {
    for (const auto& coding : kCodings) {
      const auto encoder = *Encoder::create(desc, options_of(coding));
      for (const std::size_t blocks :
           {std::size_t{0}, std::size_t{1}, std::size_t{block_count(desc)}}) {
        EXPECT_LE(encoder.bound(blocks),
                  documented_bound(desc, coding.backend, blocks, blocks == 0 ? 1 : blocks))
            << desc << " " << coding.backend;
      }
    }
  }
}

}  // namespace
}  // namespace gicodec
