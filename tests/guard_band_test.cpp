// strip, reconstruct and bands against the rule written down texel by texel in support.cpp.
#include "shapes.h"
#include "support.h"

#include "texture/blocks.h"
#include "texture/guard_band.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace gicodec {
namespace {

using namespace test;

std::vector<std::uint32_t> all_blocks(const TextureDesc& desc) {
  std::vector<std::uint32_t> blocks(block_count(desc));
  std::iota(blocks.begin(), blocks.end(), 0U);
  return blocks;
}

auto checked(Texture& texture) { return *check_view(texture.desc(), texture.view()); }
auto checked(const Texture& texture) {
  return *check_view<const std::byte>(texture.desc(), texture.view());
}

Texture random_texture(Random& random, const TextureDesc& desc) {
  return Texture(desc, random() % 3 * (random() % 33), random() % 3 * (random() % 200),
                 random() % 3 * (random() % 50));
}

TEST(GuardBand, TheRuleOnASmallBlockLiterally) {
  // Records a..i of a 3×3 block in 5×5 with its guard band.
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {1, 1, 1}, 3, 1, Tiling::atlas_xy_z);
  const std::string_view letters = "abcdefghi";
  Bytes records;
  for (const char c : letters) records.insert(records.end(), {std::byte(c), std::byte{0}});
  Texture texture(desc);
  const std::uint32_t block = 0;
  reconstruct(best_isa(), desc, checked(texture), {&block, 1}, records);
  std::string got;
  for (std::uint32_t i = 0; i < 25; ++i)
    got += static_cast<char>(texture.record(0, i % 5, i / 5)[0]);
  EXPECT_EQ(got.substr(0, 5), "icbag");
  EXPECT_EQ(got.substr(5, 5), "gabci");
  EXPECT_EQ(got.substr(10, 5), "ddeff");
  EXPECT_EQ(got.substr(15, 5), "aghic");
  EXPECT_EQ(got.substr(20, 5), "cihga");
}

RC_GTEST_PROP(Blocks, StripAndReconstructAreInverse, (std::uint64_t seed)) {
  Random random(seed);
  const auto desc = any_desc(random);
  RC_ASSERT(validate(desc) == Status::ok);
  Texture texture = random_texture(random, desc);
  texture.fill(Fill::noise, random);
  const auto blocks = random_selection(random, block_count(desc));
  const Isa isa = any_isa(random);

  Exact records(blocks.size() * block_bytes(desc));
  std::ranges::fill(records.span(), std::byte{0xEE});
  Vector<std::uint32_t> stale;
  strip(isa, desc, checked(std::as_const(texture)), blocks, records.span(), stale);
  RC_ASSERT(stale.empty());
  std::size_t at = 0;
  for (const auto block : blocks) {
    const auto inside = block_inside(desc, block);
    for (std::uint32_t z = 0; z < desc.block.z; ++z) {
      for (std::uint32_t y = 0; y < desc.block.y; ++y) {
        for (std::uint32_t x = 0; x < desc.block.x; ++x, at += desc.record.bytes) {
          const auto stripped = records.span().subspan(at, desc.record.bytes);
          if (x >= inside.x || y >= inside.y || z >= inside.z) {
            RC_ASSERT(std::ranges::count(stripped, std::byte{0}) == desc.record.bytes);
          } else {
            const auto band = desc.guard_band;
            RC_ASSERT(std::ranges::equal(texture.record(block, x + band, y + band, z), stripped));
          }
        }
      }
    }
  }

  // Into another layout of the same texture.
  TextureDesc other = desc;
  other.layout = any_layout(random, desc);
  Texture out = random_texture(random, other);
  reconstruct(isa, other, checked(out), blocks, records.span());
  RC_ASSERT(out.padding_untouched());
  ExpectedMirror model(desc);
  model.apply(texture, false, blocks);
  RC_ASSERT(out.blocks() == model.blocks());
}

RC_GTEST_PROP(GuardBand, BandsAreThoseOfTheRule, (std::uint64_t seed)) {
  Random random(seed);
  auto desc = probe_desc(random, 8000);
  desc.guard_band = 1;
  desc.record = any_record(random);
  Texture texture = random_texture(random, desc);
  texture.fill(Fill::noise, random);
  const auto block = pick(random, 0, block_count(desc) - 1);
  Exact records(block_bytes(desc)), band(band_bytes(desc)), by_rule(band_bytes(desc));
  Vector<std::uint32_t> stale;
  const auto view = checked(std::as_const(texture));
  strip(best_isa(), desc, view, {&block, 1}, records.span(), stale);
  gather_band(desc, view, block, band.span());
  band_by_rule(desc, records.span().data(), by_rule.span());
  RC_ASSERT(std::ranges::equal(band.span(), by_rule.span()));
  RC_ASSERT(stale.empty());

  // Band order: top row, sides row by row, bottom row. Scattering noise and gathering it again.
  const auto before = texture.blocks();
  const auto other = noise(random, band_bytes(desc));
  scatter_band(desc, checked(texture), block, other);
  gather_band(desc, view, block, band.span());
  RC_ASSERT(std::ranges::equal(band.span(), other));
  const std::size_t bytes = desc.record.bytes;
  const std::uint32_t n = desc.block.x + 2U;
  RC_ASSERT(std::ranges::equal(texture.record(block, n - 1, 0),
                               std::span(other).subspan((n - 1) * bytes, bytes)));
  RC_ASSERT(std::ranges::equal(texture.record(block, n - 1, 1),
                               std::span(other).subspan((n + 1) * bytes, bytes)));
  RC_ASSERT(texture.padding_untouched());
  scatter_band(desc, checked(texture), block, by_rule.span());
  RC_ASSERT(texture.blocks() == before);
}

/// Flips one bit of every record of the guard band in turn: each must be found; of every record of
/// the block: the rule is broken unless the block is its own guard band only.
void check_every_record(const TextureDesc& desc) {
  SCOPED_TRACE(testing::PrintToString(int{desc.block.x}));
  Random random(desc.block.x);
  Texture texture(desc, 8);
  texture.fill(Fill::noise, random);
  const auto blocks = all_blocks(desc);
  const auto block = pick(random, 0, block_count(desc) - 1);
  const std::uint32_t n = desc.block.x + 2U;
  Exact records(blocks.size() * block_bytes(desc));
  const auto view = checked(std::as_const(texture));
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const auto record = texture.record(block, x, y);
      const auto mask = static_cast<std::byte>(1U << random() % 8);
      const auto at = random() % record.size();
      record[at] ^= mask;
      Vector<std::uint32_t> stale;
      strip(best_isa(), desc, view, blocks, records.span(), stale);
      const bool inside = x > 0 && y > 0 && x < n - 1 && y < n - 1;
      const bool at_edge = inside && (x == 1 || y == 1 || x == n - 2 || y == n - 2);
      const Vector<std::uint32_t> expected =
          !inside || at_edge ? Vector<std::uint32_t>{block} : Vector<std::uint32_t>{};
      EXPECT_EQ(stale, expected) << x << "," << y;
      record[at] ^= mask;
    }
  }
}

TEST(GuardBand, EverySingleRecordChangeIsFound) {
  for (const std::uint8_t side : std::initializer_list<std::uint8_t>{1, 2, 3, 6, 7, 8, 16, 17}) {
    for (const auto format :
         {Format::R8_UNORM, Format::R16_SFLOAT, Format::R8G8B8_SNORM, Format::R16G16_SFLOAT,
          Format::R16G16B16A16_SFLOAT, Format::R32G32B32_SFLOAT, Format::R32G32B32A32_SFLOAT}) {
      check_every_record(probe_texture(format, {2, 1, 2}, side, 1, Tiling::slices_xz_y));
    }
  }
  check_every_record(
      probe_texture(Format::A2R10G10B10_UNORM_PACK32, {1, 1, 1}, 64, 1, Tiling::atlas_x_yz));
}

TEST(GuardBand, WithoutAGuardBandNothingIsStale) {
  const TextureDesc desc =
      probe_texture(Format::R16G16_SFLOAT, {3, 3, 1}, 5, 0, Tiling::atlas_xy_z);
  Random random(5);
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  EXPECT_EQ(band_bytes(desc), 0U);
  gather_band(desc, checked(std::as_const(texture)), 4, {});
  scatter_band(desc, checked(texture), 4, {});
}

}  // namespace
}  // namespace gicodec
