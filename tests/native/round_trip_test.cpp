// Payloads of textures of all records, shapes and presences (round_trip.h).
#include "native/round_trip.h"
#include "distinct_formats.h"
#include "shapes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numeric>

namespace gicodec {
namespace {

using test::any_update;
using test::Bytes;
using test::check_everything;

/// Any record, odd sides, small grids.
TextureDesc small_desc(test::Random& random) {
  const auto side =
      static_cast<std::uint8_t>(test::pick(random, 1, test::chance(random, 4) ? 17 : 9));
  TextureDesc desc =
      probe_texture(Format::R32_SFLOAT,
                    {test::pick(random, 1, 7), test::pick(random, 1, 5), test::pick(random, 1, 6)},
                    side, static_cast<std::uint8_t>(random() % 2));
  desc.record = test::any_record(random);
  return desc;
}

Grid any_box(test::Random& random, const Grid& grid) {
  return {test::pick(random, 1, grid.x), test::pick(random, 1, grid.y),
          test::pick(random, 1, grid.z)};
}

void check_formats(const native::PayloadSettings& settings) {
  test::Sweep sweep;
  for (const auto& format : test::distinct_formats()) {
    const TextureDesc desc = probe_texture(format.record, {6, 4, 5}, 6, 1);
    for (const auto content : test::kContents) {
      for (const bool keyframe : {true, false}) {
        if (!sweep.takes()) continue;
        check_everything(test::make_update(desc, content, keyframe, 1, 5), settings);
      }
    }
  }
}

RC_GTEST_PROP(NativeRoundTrip, AnyTexture, (std::uint64_t seed)) {
  test::Random random(seed);
  const auto desc = small_desc(random);
  const auto content = test::kContents[random() % std::size(test::kContents)];
  native::PayloadSettings settings;
  if (test::chance(random, 4)) settings.chunk.preset = native::Preset::strong;
  if (test::chance(random, 2)) settings.box = any_box(random, desc.grid);
  if (test::chance(random, 3)) settings.chunk.lanes = 1U << test::pick(random, 0, 5);
  check_everything(any_update(desc, content, test::pick(random, 1, 4), seed), settings);
  RC_ASSERT(!testing::Test::HasFailure());
}

TEST(NativeRoundTrip, EveryFormatAndContent) { check_formats({}); }

/// Probes that enter a volume are predicted from those that are there.
TEST(NativeRoundTrip, FreshUpdatesCostLessThanKeyframes) {
  for (const auto& desc : {ddgi_irradiance({4, 8, 8}), ddgi_visibility({4, 8, 8})}) {
    test::UpdateCase intra = test::make_intra(desc, test::Content::smooth, 1, 5);
    const std::size_t size = block_bytes(desc);
    Bytes records;
    std::erase_if(intra.blocks, [&](std::uint32_t b) {
      if (b % 4 != 3) return true;
      const auto block = std::span(intra.records).subspan(b * size, size);
      records.insert(records.end(), block.begin(), block.end());
      return false;
    });
    intra.records = std::move(records);
    intra.mirror = test::make_records(desc, test::Content::smooth, 0, 5);
    intra.received.assign(block_count(desc), 1);
    check_everything(intra, {});
    test::UpdateCase keyframe = intra;
    keyframe.intra = false;
    native::PayloadSettings settings;
    settings.chunk.others = false;  // matches know no neighbours
    const auto bytes = [&](const auto& u) { return test::encode(u, settings, best_isa()).size(); };
    EXPECT_LT(bytes(intra), bytes(keyframe));
  }
}

/// Token chunks of any records, shapes and boxes.
RC_GTEST_PROP(NativeRoundTrip, AnyTextureByTokens, (std::uint64_t seed)) {
  test::Random random(seed);
  TextureDesc desc = small_desc(random);
  if (test::chance(random, 3)) {
    desc.guard_band = 0;
    desc.block = {static_cast<std::uint8_t>(test::pick(random, 1, 40)),
                  static_cast<std::uint8_t>(test::pick(random, 1, 9)),
                  static_cast<std::uint8_t>(test::pick(random, 1, 5))};
    if (test::chance(random, 2)) desc.model = Model::continuous;
  }
  const auto content = test::kContents[random() % std::size(test::kContents)];
  native::PayloadSettings settings;
  settings.chunk.preset = native::Preset::turbo;
  settings.chunk.streams = 4U << test::pick(random, 0, 4);
  if (test::chance(random, 2)) settings.box = any_box(random, desc.grid);
  check_everything(any_update(desc, content, test::pick(random, 1, 4), seed), settings);
  RC_ASSERT(!testing::Test::HasFailure());
}

TEST(NativeRoundTrip, EveryFormatAndContentByTokens) {
  native::PayloadSettings settings;
  settings.chunk.preset = native::Preset::turbo;
  check_formats(settings);
}

/// Blocks of any shape, on grids and in pools, whatever their neighbours are to them.
RC_GTEST_PROP(NativeRoundTrip, AnyShape, (std::uint64_t seed)) {
  test::Random random(seed);
  TextureDesc desc = small_desc(random);
  desc.guard_band = 0;
  if (test::chance(random, 2)) {
    desc = pool_texture(desc.record, test::pick(random, 1, 90), {1, 1, 1});
  } else {
    constexpr std::array kModels{Model::none, Model::stacked, Model::continuous};
    desc.model = kModels[random() % kModels.size()];
  }
  desc.block = {static_cast<std::uint8_t>(test::pick(random, 1, 9)),
                static_cast<std::uint8_t>(test::pick(random, 1, 9)),
                static_cast<std::uint8_t>(test::pick(random, 1, 5))};
  const auto content = test::kContents[random() % std::size(test::kContents)];
  native::PayloadSettings settings;
  if (test::chance(random, 4)) settings.chunk.preset = native::Preset::strong;
  check_everything(any_update(desc, content, test::pick(random, 1, 4), seed), settings);
  RC_ASSERT(!testing::Test::HasFailure());
}

/// Blocks some records of which exist, or none, by counts and masks.
RC_GTEST_PROP(NativeRoundTrip, AnyPresence, (std::uint64_t seed)) {
  test::Random random(seed);
  TextureDesc desc = test::any_desc(random, 6000);
  desc.guard_band = 0;
  if (desc.model > Model::continuous) desc.model = Model::none;
  desc.presence = test::chance(random, 2) ? Presence::count : Presence::mask;
  const auto content = test::kContents[random() % std::size(test::kContents)];
  native::PayloadSettings settings;
  if (test::chance(random, 4)) settings.chunk.preset = native::Preset::strong;
  check_everything(any_update(desc, content, test::pick(random, 1, 3), seed), settings);
  RC_ASSERT(!testing::Test::HasFailure());
}

/// What did not change costs next to nothing, in boxes of any size.
TEST(NativeRoundTrip, UnchangedRecordsOfPools) {
  TextureDesc desc = pool_texture(Format::R8G8B8A8_UNORM, 150000, {7, 1, 1});
  auto u = test::make_update(desc, test::Content::white, false, 20, 4);
  std::ranges::fill(u.received, std::uint8_t{1});
  const std::size_t size = block_bytes(desc);
  for (std::size_t b = 0; b < u.blocks.size(); ++b) {
    std::memcpy(u.mirror.data() + u.blocks[b] * size, u.records.data() + b * size, size);
    if (b % 8 == 0) u.records[b * size + 3] ^= std::byte{1};
  }
  check_everything(u, {});
  EXPECT_LE(test::encode(u, {}, best_isa()).size(), u.blocks.size() * 12 / 8);
}

/// Every shape and content by adaptive chunks: those of all textures but probes, if there is time.
RC_GTEST_PROP(NativeRoundTrip, AnyShapeAdaptively, (std::uint64_t seed)) {
  test::Random random(seed);
  TextureDesc desc = test::any_desc(random, 3000);
  if (desc.model == Model::stacked) desc.model = Model::continuous;
  const auto content = test::kContents[random() % std::size(test::kContents)];
  native::PayloadSettings settings;
  settings.chunk.preset = native::Preset::strong;
  check_everything(any_update(desc, content, test::pick(random, 1, 4), seed), settings);
  RC_ASSERT(!testing::Test::HasFailure());
}

RC_GTEST_PROP(NativeRoundTrip, StrongIsNeverLargerThanFast, (std::uint64_t seed)) {
  test::Random random(seed);
  const TextureDesc desc = test::any_desc(random, 3000);
  const auto content = test::kContents[random() % std::size(test::kContents)];
  const auto u = test::any_update(desc, content, test::pick(random, 1, 4), seed);
  native::PayloadSettings strong;
  strong.chunk.preset = native::Preset::strong;
  RC_ASSERT(test::encode(u, strong, best_isa()).size() <= test::encode(u, {}, best_isa()).size());
}

TEST(NativeRoundTrip, EveryFormatInPart) {
  test::Sweep sweep;
  for (const auto& format : test::distinct_formats()) {
    TextureDesc desc = pool_texture(format.record, 80, {4, 4, 2});
    for (const Presence presence : {Presence::count, Presence::mask}) {
      desc.presence = presence;
      for (const bool keyframe : {true, false}) {
        if (!sweep.takes()) continue;
        check_everything(test::make_update(desc, test::Content::noisy, keyframe, 1, 5), {});
      }
    }
  }
}

/// The same bytes as if no record could be absent, and no more than the modes for each that is.
TEST(NativeRoundTrip, WhatIsAbsentCostsNothing) {
  TextureDesc desc = pool_texture(Format::E5B9G9R9_UFLOAT_PACK32, 200, {4, 4, 4});
  const auto all = test::make_update(desc, test::Content::noisy, true, 1, 3);
  const auto size = [](const test::UpdateCase& u) {
    return test::encode(u, {}, best_isa()).size();
  };
  for (const Presence presence : {Presence::count, Presence::mask}) {
    auto u = all;
    u.desc.presence = presence;
    u.presence = test::full_presence(u.desc);
    EXPECT_EQ(test::encode(u, {}, best_isa()), test::encode(all, {}, best_isa()));
    std::ranges::fill(u.presence, std::byte{0});
    std::ranges::fill(u.records, std::byte{0});
    EXPECT_EQ(size(u), 2U);
    // One record in every eighth block.
    const std::size_t each = 8 * presence_bytes(u.desc);
    for (std::size_t i = 0; i < u.presence.size(); i += each) {
      u.presence[i] = std::byte{1};
      std::ranges::copy_n(all.records.begin() + static_cast<std::ptrdiff_t>(i / each * 8 * 256), 4,
                          u.records.begin() + static_cast<std::ptrdiff_t>(i / each * 8 * 256));
    }
    EXPECT_LE(size(u), 5 + 25 * 4);
    check_everything(u, {});
  }
}

/// The most planes and the largest blocks that there are.
TEST(NativeRoundTrip, OtherRecordsAndShapes) {
  test::Sweep sweep;
  Record record;  // of components that take two planes each
  for (std::uint8_t count = 1; count <= kMaxComponents; ++count) {
    record.components[count - 1U] = {std::string_view("abcdefghijklmnop").substr(count - 1U, 1),
                                     static_cast<std::uint16_t>(32 * (count - 1)), 32,
                                     ComponentType::uint};
    record.count = count;
    record.bytes = static_cast<std::uint8_t>(4 * count);
    for (const bool keyframe : {true, false}) {
      for (const Presence presence : {Presence::all, Presence::mask}) {
        if (!sweep.takes()) continue;
        TextureDesc desc = pool_texture(record, 40, {3, 2, 1});
        desc.presence = presence;
        check_everything(test::make_update(desc, test::Content::smooth, keyframe, 1, count), {});
      }
    }
  }
  for (const Presence presence : {Presence::all, Presence::count, Presence::mask}) {
    TextureDesc desc = pool_texture(Format::R8_UNORM, 3, {32, 32, 32});
    desc.presence = presence;
    check_everything(test::make_update(desc, test::Content::smooth, false, 1, 7), {});
  }
}

TEST(NativeRoundTrip, SidesOfEveryKind) {
  constexpr std::uint8_t kSides[] = {1, 2, 3, 5, 7, 14, 16, 33, 64};
  for (const std::uint8_t core : kSides) {
    check_everything(test::make_update(probe_texture(Format::R16G16_SFLOAT, {2, 2, 1}, core, 1),
                                       test::Content::noisy, false, 1, core),
                     {});
    check_everything(
        test::make_update(probe_texture(Format::A2B10G10R10_UNORM_PACK32, {2, 2, 1}, core, 1),
                          test::Content::noisy, true, 1, core),
        {});
  }
}

TEST(NativeRoundTrip, FullLanes) {
  for (const bool keyframe : {true, false}) {
    for (const auto content : {test::Content::smooth, test::Content::noisy}) {
      check_everything(test::make_update(ddgi_irradiance({9, 8, 10}), content, keyframe, 1, 3), {});
      check_everything(test::make_update(ddgi_visibility({8, 6, 7}), content, keyframe, 1, 3), {});
    }
  }
}

TEST(NativeRoundTrip, NoBlocks) {
  auto u = test::make_update(ddgi_irradiance({4, 4, 4}), test::Content::smooth, false, 1, 1);
  u.blocks.clear();
  u.records.clear();
  check_everything(u, {});
}

/// Expansion never exceeds what docs/native.md states.
TEST(NativeRoundTrip, ExpansionIsBounded) {
  unsigned tried = 0;
  for (const auto& format : test::distinct_formats()) {
    const TextureDesc desc = probe_texture(format.record, {5, 4, 4}, 5, 1);
    for (const auto content : test::kContents) {
      for (const std::uint32_t one_in : {1U, 3U, 40U}) {
        if (!test::everything() && tried++ % 5 != 0) continue;
        const auto u = test::make_update(desc, content, false, one_in, 9);
        for (const Grid& box : {desc.grid, Grid{4, 3, 2}, Grid{1, 1, 1}}) {
          native::ChunkLists lists;
          native::split(desc.grid, native::chunk_grid(desc.grid, box), u.blocks, lists);
          const std::size_t size = test::encode(u, {{}, box}, best_isa()).size();
          EXPECT_LE(size, 16 + 8 * lists.chunk.size() + u.records.size());
        }
      }
    }
  }
}

/// Light of every brightness costs what light of one exponent does.
TEST(NativeRoundTrip, MantissasFollowTheirExponents) {
  const auto desc = probe_texture(Format::E5B9G9R9_UFLOAT_PACK32, {16, 8, 8}, 8, 1);
  const auto size_over = [&](double octaves) {
    test::Random random(11);
    Bytes records;
    for (std::size_t t = 0; t < block_count(desc) * record_count(desc.block); ++t) {
      const double place = static_cast<double>(t % 64) / 64;
      const double noise = test::pick(random, 0, 15) / 4000.0;
      const double light = std::exp2(14.01 + octaves * place * place) * (1 + noise);
      const int exponent = static_cast<int>(std::log2(light));
      const auto most = static_cast<std::uint32_t>(std::ldexp(light, 8 - exponent));
      const std::uint32_t texel =
          most | most * 3 / 4 << 9 | most / 2 << 18 | static_cast<std::uint32_t>(exponent) << 27;
      for (unsigned i = 0; i < 4; ++i) records.push_back(std::byte(texel >> 8 * i & 0xFF));
    }
    test::UpdateCase u{desc, {}, records, {}, {}, true, {}};
    u.blocks.resize(block_count(desc));
    std::iota(u.blocks.begin(), u.blocks.end(), 0U);
    check_everything(u, {});
    return static_cast<double>(test::encode(u, {}, best_isa()).size());
  };
  EXPECT_LE(size_over(6), 1.25 * size_over(0.9));
}

/// A few blocks cost little more than their share of a full update.
TEST(NativeRoundTrip, SmallUpdates) {
  const auto desc = ddgi_irradiance({16, 8, 8});
  auto all = test::make_update(desc, test::Content::noisy, false, 1, 7);
  const double share = static_cast<double>(test::encode(all, {}, best_isa()).size()) /
                       static_cast<double>(all.blocks.size());
  for (const std::size_t n : {1U, 8U, 32U, 100U}) {
    auto some = all;
    some.blocks.assign(all.blocks.begin() + 200, all.blocks.begin() + 200 + n);
    some.records.assign(all.records.begin() + 200 * 256, all.records.begin() + (200 + n) * 256);
    const double size = static_cast<double>(test::encode(some, {}, best_isa()).size());
    EXPECT_LE(size, 24 + static_cast<double>(n) * share * 1.35) << n << " blocks";
  }
}

}  // namespace
}  // namespace gicodec
