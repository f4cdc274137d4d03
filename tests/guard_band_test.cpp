// strip, reconstruct and rings against the rule written down texel by texel in support.cpp.
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

std::vector<std::uint32_t> all_probes(const TextureDesc& desc) {
  std::vector<std::uint32_t> probes(probe_count(desc));
  std::iota(probes.begin(), probes.end(), 0U);
  return probes;
}

auto checked(Texture& texture) { return *check_view(texture.desc(), texture.view()); }
auto checked(const Texture& texture) {
  return *check_view<const std::byte>(texture.desc(), texture.view());
}

Texture random_texture(Random& random, TextureDesc desc) {
  return Texture(desc, random() % 3 * (random() % 33), random() % 3 * (random() % 200));
}

TEST(GuardBand, TheRuleOnASmallBlockLiterally) {
  // Core texels a..i of a 3×3 core in a 5×5 block.
  const TextureDesc desc{Format::R16_SFLOAT, {1, 1, 1}, 3, 1, Tiling::atlas_xy_z};
  const std::string_view core = "abcdefghi";
  Bytes cores;
  for (const char c : core) cores.insert(cores.end(), {std::byte(c), std::byte{0}});
  Texture texture(desc);
  const std::uint32_t probe = 0;
  reconstruct(best_isa(), desc, checked(texture), {&probe, 1}, cores);
  std::string got;
  for (std::uint32_t i = 0; i < 25; ++i)
    got += static_cast<char>(texture.texel(0, i % 5, i / 5)[0]);
  EXPECT_EQ(got.substr(0, 5), "icbag");
  EXPECT_EQ(got.substr(5, 5), "gabci");
  EXPECT_EQ(got.substr(10, 5), "ddeff");
  EXPECT_EQ(got.substr(15, 5), "aghic");
  EXPECT_EQ(got.substr(20, 5), "cihga");
}

RC_GTEST_PROP(GuardBand, StripAndReconstructAreInverse, (std::uint64_t seed)) {
  Random random(seed);
  const auto desc = random_desc(random);
  Texture texture = random_texture(random, desc);
  texture.fill(Fill::noise, random);
  const auto probes = random_selection(random, probe_count(desc));

  Exact cores(probes.size() * core_bytes(desc));
  std::vector<std::uint32_t> stale;
  strip(best_isa(), desc, checked(std::as_const(texture)), probes, cores.span(), stale);
  RC_ASSERT(stale.empty());
  std::size_t at = 0;
  for (const auto probe : probes) {
    for (std::uint32_t y = 0; y < desc.core; ++y) {
      for (std::uint32_t x = 0; x < desc.core; ++x) {
        const auto texel = texture.texel(probe, x + desc.border, y + desc.border);
        RC_ASSERT(std::ranges::equal(texel, cores.span().subspan(at, texel.size())));
        at += texel.size();
      }
    }
  }

  Texture out = random_texture(random, desc);
  reconstruct(best_isa(), desc, checked(out), probes, cores.span());
  RC_ASSERT(out.padding_untouched());
  Model model(desc);
  model.apply(texture, false, probes);
  RC_ASSERT(out.blocks() == model.blocks());
}

RC_GTEST_PROP(GuardBand, RingsAreThoseOfTheRule, (std::uint64_t seed)) {
  Random random(seed);
  auto desc = random_desc(random, 8000);
  desc.border = 1;
  Texture texture = random_texture(random, desc);
  texture.fill(Fill::noise, random);
  const auto probe = pick(random, 0, probe_count(desc) - 1);
  Exact core(core_bytes(desc)), ring(ring_bytes(desc)), by_rule(ring_bytes(desc));
  std::vector<std::uint32_t> stale;
  const auto view = checked(std::as_const(texture));
  strip(best_isa(), desc, view, {&probe, 1}, core.span(), stale);
  gather_ring(desc, view, probe, ring.span());
  ring_by_rule(desc, core.span().data(), by_rule.span());
  RC_ASSERT(std::ranges::equal(ring.span(), by_rule.span()));
  RC_ASSERT(stale.empty());

  // Ring order: top row, sides row by row, bottom row. Scattering noise and gathering it again.
  const auto before = texture.blocks();
  const auto other = noise(random, ring_bytes(desc));
  scatter_ring(desc, checked(texture), probe, other);
  gather_ring(desc, view, probe, ring.span());
  RC_ASSERT(std::ranges::equal(ring.span(), other));
  const std::size_t bytes = texel_bytes(desc);
  const auto n = block_side(desc);
  RC_ASSERT(std::ranges::equal(texture.texel(probe, n - 1, 0),
                               std::span(other).subspan((n - 1) * bytes, bytes)));
  RC_ASSERT(std::ranges::equal(texture.texel(probe, n - 1, 1),
                               std::span(other).subspan((n + 1) * bytes, bytes)));
  RC_ASSERT(texture.padding_untouched());
  scatter_ring(desc, checked(texture), probe, by_rule.span());
  RC_ASSERT(texture.blocks() == before);
}

/// Flips one bit of every border texel in turn: each must be found; of every core texel: the rule
/// is broken unless the core is its own border only.
void check_every_border_texel(TextureDesc desc) {
  SCOPED_TRACE(testing::PrintToString(desc.core));
  Random random(desc.core);
  Texture texture(desc, 8);
  texture.fill(Fill::noise, random);
  const auto probes = all_probes(desc);
  const auto probe = pick(random, 0, probe_count(desc) - 1);
  const auto n = block_side(desc);
  Exact cores(probes.size() * core_bytes(desc));
  const auto view = checked(std::as_const(texture));
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const auto texel = texture.texel(probe, x, y);
      const auto mask = static_cast<std::byte>(1U << random() % 8);
      const auto at = random() % texel.size();
      texel[at] ^= mask;
      std::vector<std::uint32_t> stale;
      strip(best_isa(), desc, view, probes, cores.span(), stale);
      const bool inside = x > 0 && y > 0 && x < n - 1 && y < n - 1;
      const bool at_edge = inside && (x == 1 || y == 1 || x == n - 2 || y == n - 2);
      const std::vector<std::uint32_t> expected =
          !inside || at_edge ? std::vector<std::uint32_t>{probe} : std::vector<std::uint32_t>{};
      EXPECT_EQ(stale, expected) << x << "," << y;
      texel[at] ^= mask;
    }
  }
}

TEST(GuardBand, EverySingleTexelChangeIsFound) {
  for (const std::uint16_t core : std::initializer_list<std::uint16_t>{1, 2, 3, 6, 7, 8, 16, 17}) {
    for (const auto format : {Format::R16_SFLOAT, Format::R16G16_SFLOAT,
                              Format::R16G16B16A16_SFLOAT, Format::R32G32B32A32_SFLOAT}) {
      check_every_border_texel({format, {2, 1, 2}, core, 1, Tiling::slices_xz_y});
    }
  }
  check_every_border_texel(
      {Format::A2R10G10B10_UNORM_PACK32, {1, 1, 1}, 64, 1, Tiling::atlas_x_yz});
}

TEST(GuardBand, WithoutABorderNothingIsStale) {
  const TextureDesc desc{Format::R16G16_SFLOAT, {3, 3, 1}, 5, 0, Tiling::atlas_xy_z};
  Random random(5);
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  EXPECT_EQ(ring_bytes(desc), 0U);
  gather_ring(desc, checked(std::as_const(texture)), 4, {});
  scatter_ring(desc, checked(texture), 4, {});
}

}  // namespace
}  // namespace gicodec
