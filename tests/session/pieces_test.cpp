// The parts that a server is made of: geometry, regions, priorities, differences, block histories.
#include "shapes.h"

#include <gicodec/probes.h>
#include <gicodec/volume.h>

#include "quantise/block_difference.h"
#include "session/server/priority.h"
#include "stream/block_history.h"
#include "texture/view.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <set>

namespace gicodec {
namespace {

using namespace test;

TEST(VolumeGeometry, Validate) {
  EXPECT_EQ(validate({{2, 3, 4}, {}, {1, 2, 3}}), Status::ok);
  const float infinity = std::numeric_limits<float>::infinity();
  for (const VolumeGeometry& bad :
       {VolumeGeometry{{0, 1, 1}}, VolumeGeometry{{kMaxBlocks, 2, 1}},
        VolumeGeometry{{1, 1, 1}, {infinity, 0, 0}}, VolumeGeometry{{1, 1, 1}, {}, {1, 0, 1}},
        VolumeGeometry{{1, 1, 1}, {}, {1, -1, 1}}}) {
    EXPECT_EQ(validate(bad), Status::invalid_geometry);
  }
}

TEST(VolumeGeometry, TheCageOfEightShadesAPoint) {
  const VolumeGeometry geometry{{4, 3, 5}, {10, 20, 30}, {2, 4, 8}};
  const auto blocks = [&](Position point) {
    BlockMask mask(60);
    add_shading_probes(geometry, std::span(&point, 1), mask);
    std::set<std::uint32_t> set;
    for (std::uint32_t i = 0; i < mask.size(); ++i) {
      if (mask[i] != 0) set.insert(i);
    }
    return set;
  };
  const auto cage = [](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    std::set<std::uint32_t> set;
    for (std::uint32_t i = 0; i < 8; ++i) {
      set.insert(x + (i & 1) + 4 * (y + (i >> 1 & 1) + 3 * (z + (i >> 2))));
    }
    return set;
  };
  EXPECT_EQ(blocks({11, 22, 34}), cage(0, 0, 0));
  EXPECT_EQ(blocks({15.9F, 27.9F, 61}), cage(2, 1, 3));
  EXPECT_EQ(blocks({-100, -100, -100}), cage(0, 0, 0));
  EXPECT_EQ(blocks({1e30F, 1e30F, 1e30F}), cage(2, 1, 3));
  EXPECT_TRUE(blocks({std::nanf(""), 0, 0}).empty());
}

RC_GTEST_PROP(RegionGrid, EveryBlockIsInOneRegion, (std::uint64_t seed)) {
  Random random(seed);
  const auto side = [&] { return pick(random, 1, 9); };
  const Grid grid{side(), side(), side()};
  const RegionGrid regions(grid, {side(), side(), side()});
  std::vector<std::uint32_t> all;
  for (std::uint32_t region = 0; region < regions.regions(); ++region) {
    const auto blocks = regions.blocks_of(region);
    const Grid of = regions.grid_of(region);
    RC_ASSERT(blocks.size() == std::size_t{of.x} * of.y * of.z);
    for (const std::uint32_t block : blocks) RC_ASSERT(regions.region_of(block) == region);
    all.insert(all.end(), blocks.begin(), blocks.end());
  }
  std::ranges::sort(all);
  RC_ASSERT(all.size() == std::size_t{grid.x} * grid.y * grid.z);
  RC_ASSERT(std::ranges::adjacent_find(all) == all.end() && all.back() == all.size() - 1);
}

TEST(RegionGrid, SidesOfAnySizeMakeRegions) {
  constexpr Grid kGrid{5, 4, 3};
  for (const Grid size : {Grid{0, 0, 0}, Grid{UINT32_MAX, 1, 2}, Grid{3, UINT32_MAX, 0}}) {
    const RegionGrid regions(kGrid, size);
    std::size_t blocks = 0;
    for (std::uint32_t region = 0; region < regions.regions(); ++region) {
      blocks += regions.blocks_of(region).size();
    }
    EXPECT_EQ(blocks, 60U);
  }
}

RC_GTEST_PROP(Priority, TheOldestHalfIsAlwaysChosen, (std::uint64_t seed)) {
  Random random(seed);
  std::vector<Candidate> all(pick(random, 0, 60));
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    all[i] = {i % 3, i, pick(random, 0, 9), static_cast<float>(pick(random, 0, 100)) / 100};
  }
  const std::size_t limit = pick(random, 1, 70);
  auto chosen = all;
  choose(chosen, limit);
  RC_ASSERT(chosen.size() == std::min(limit, all.size()));
  const auto place = [](const Candidate& c) { return std::pair(c.bundle, c.block); };
  RC_ASSERT(std::ranges::is_sorted(chosen, {}, place));
  auto by_age = all;
  std::ranges::stable_sort(by_age, std::ranges::greater(), &Candidate::age);
  by_age.resize(std::min((limit + 1) / 2, by_age.size()));
  for (const Candidate& old : by_age) {
    const auto as_old = std::ranges::count_if(chosen, [&](auto& c) { return c.age >= old.age; });
    RC_ASSERT(as_old > 0);
  }
  const auto ages_at_least = [](const auto& list, std::uint32_t age) {
    return std::ranges::count_if(list, [&](auto& c) { return c.age >= age; });
  };
  for (std::uint32_t age = 0; age < 10; ++age) {
    RC_ASSERT(ages_at_least(chosen, age) >= ages_at_least(by_age, age));
  }
}

RC_GTEST_PROP(Priority, FirstPartsAreSpreadAndNeighboursApart, (std::uint64_t seed)) {
  Random random(seed);
  const Grid grid = {pick(random, 1, 12), pick(random, 1, 12), pick(random, 1, 12)};
  std::vector<std::uint32_t> order(std::size_t{grid.x} * grid.y * grid.z);
  std::iota(order.begin(), order.end(), 0U);
  const auto parity = [&](std::uint32_t block) {
    return (block % grid.x + block / grid.x % grid.y + block / grid.x / grid.y) % 2;
  };
  const auto even = static_cast<std::size_t>(
      std::ranges::count_if(order, [&](auto block) { return parity(block) == 0; }));
  std::ranges::sort(order, {}, [&](auto block) { return spread_order(grid, block); });
  for (std::size_t i = 0; i < order.size(); ++i) RC_ASSERT((parity(order[i]) == 0) == (i < even));
  std::vector<std::uint32_t> keys(order.size());
  for (std::uint32_t i = 0; i < keys.size(); ++i) keys[i] = spread_order(grid, i);
  std::ranges::sort(keys);
  RC_ASSERT(std::ranges::adjacent_find(keys) == keys.end());
}

TEST(BlockDifference, Thresholds) {
  const auto words = [](std::uint32_t word) {
    Bytes bytes(4);
    std::memcpy(bytes.data(), &word, 4);
    return bytes;
  };
  const TextureDesc colour = probe_texture(Format::A2R10G10B10_UNORM_PACK32, {1, 1, 1}, 1, 0);
  EXPECT_FALSE(differs_by_more(colour, words(5), words(5), 0));
  EXPECT_TRUE(differs_by_more(colour, words(5), words(6), 0));
  EXPECT_FALSE(differs_by_more(colour, words(5), words(7), 2));
  EXPECT_TRUE(differs_by_more(colour, words(5), words(8), 2));
  EXPECT_TRUE(differs_by_more(colour, words(5U << 20), words(1U << 20), 3));
  const TextureDesc distance = probe_texture(Format::R16G16_SFLOAT, {1, 1, 1}, 1, 0);
  EXPECT_FALSE(differs_by_more(distance, words(0x3C00), words(0x3C01), 0.01F));  // 1 and 1.001
  EXPECT_TRUE(differs_by_more(distance, words(0x3C00), words(0x3C01), 0.0001F));
  EXPECT_TRUE(differs_by_more(distance, words(0x3C00), words(0x3D00), 0.2F));  // 1 and 1.25
  EXPECT_FALSE(differs_by_more(distance, words(0x3C00), words(0x3D00), 0.3F));
  EXPECT_TRUE(differs_by_more(distance, words(0x3C00), words(0xBC00), 1.5F));  // 1 and -1
  EXPECT_TRUE(differs_by_more(distance, words(0x7E00), words(0x7E01), 10));    // Two NaNs.
  EXPECT_FALSE(differs_by_more(distance, words(0x7E00), words(0x7E00), 10));
  for (const float threshold : {0.01F, 0.9F, 10.0F}) {
    constexpr std::uint32_t kOne = 0x3C00, kInfinity = 0x7C00, kMinus = 0x8000;
    EXPECT_TRUE(differs_by_more(distance, words(kOne), words(kInfinity), threshold));
    EXPECT_TRUE(differs_by_more(distance, words(kInfinity), words(kOne), threshold));
    EXPECT_TRUE(differs_by_more(distance, words(kInfinity), words(kInfinity | kMinus), threshold));
    EXPECT_TRUE(differs_by_more(distance, words(0), words(kMinus), threshold));
    EXPECT_TRUE(differs_by_more(distance, words(0), words(3), threshold));
  }
  const TextureDesc shared = probe_texture(Format::E5B9G9R9_UFLOAT_PACK32, {1, 1, 1}, 1, 0);
  EXPECT_TRUE(differs_by_more(shared, words(18U << 27), words(17U << 27), 2));
  EXPECT_FALSE(differs_by_more(shared, words(18U << 27 | 5), words(18U << 27 | 7), 2));
  EXPECT_FLOAT_EQ(changed_share(distance, words(1), words(1)), 0);
  EXPECT_FLOAT_EQ(changed_share(distance, words(1), words(2)), 1);
}

RC_GTEST_PROP(BlockHistory, HeldBlocksStayAndOthersGo, (std::uint64_t seed)) {
  Random random(seed);
  const auto desc = any_desc(random, 2000);
  const auto total = block_count(desc);
  std::vector<std::uint32_t> all(total);
  std::iota(all.begin(), all.end(), 0U);
  Texture texture(desc);
  BlockHistory history(desc, best_isa(), BlockHistory::Use::server);
  // What was current when it was held.
  struct Held {
    BlockId id;
    Bytes records, band, presence;
  };
  std::vector<Held> held;
  const auto bytes = [](std::span<const std::byte> span) {
    return Bytes(span.begin(), span.end());
  };
  Bytes presence = any_presence(random, desc);
  const auto publish = [&] {
    history.publish(*check_view<const std::byte>(desc, std::as_const(texture).view()), all,
                    presence);
  };
  for (int step = 0; step < 8; ++step) {
    for (const auto block : random_selection(random, total)) {
      texture.fill_block(block, chance(random, 3) ? Fill::zero : Fill::noise, random);
      if (!chance(random, 3)) texture.fill_band(block);
    }
    if (chance(random, 3)) presence = any_presence(random, desc);
    publish();
    for (const Held& old : held) {
      RC_ASSERT(bytes(history.records(old.id)) == old.records);
      RC_ASSERT(bytes(history.stale_band(old.id)) == old.band);
      RC_ASSERT(bytes(history.presence(old.id)) == old.presence);
    }
    for (const auto block : random_selection(random, total)) {
      const BlockId id = history.current()[block];
      RC_ASSERT(id != kNothing);
      history.hold(id);
      held.push_back({id, bytes(history.records(id)), bytes(history.stale_band(id)),
                      bytes(history.presence(id))});
    }
    while (!held.empty() && !chance(random, 5)) {
      history.release(held.back().id);
      held.pop_back();
    }
  }
  for (const Held& old : held) history.release(old.id);
  publish();
  RC_ASSERT(history.size() <= total + 2);
}

/// What a number of blocks counts as, and that a rank of nothing waits and comes.
TEST(Priority, WhatTravelsTogetherCountsAsSeveral) {
  std::vector<Candidate> all(6);
  for (std::uint32_t i = 0; i < 6; ++i) all[i] = {.bundle = 0, .block = i, .age = i, .blocks = 2};
  auto chosen = all;
  choose(chosen, 5);
  EXPECT_EQ(blocks_of(chosen), 4U);
  chosen = all;
  choose(chosen, 1);  // One may always go.
  ASSERT_EQ(chosen.size(), 1U);
  EXPECT_EQ(chosen[0].block, 5U);
  chosen = {{.block = 0, .age = 9, .blocks = 1}, {.block = 1, .age = 5, .blocks = 5}};
  choose(chosen, 3);  // But not beside another.
  EXPECT_EQ(blocks_of(chosen), 1U);
}

TEST(Priority, HigherRanksComeFirstAndNobodyStarves) {
  constexpr std::uint32_t kCandidates = 20;
  std::vector<std::uint32_t> age(kCandidates), sent(kCandidates);
  for (int update = 0; update < 2000; ++update) {
    std::vector<Candidate> all(kCandidates);
    for (std::uint32_t i = 0; i < kCandidates; ++i) {
      all[i] = {.block = i, .age = age[i]++, .weight = static_cast<float>(i * i), .ranked = true};
    }
    choose(all, 1);
    ASSERT_EQ(all.size(), 1U);
    if (update == 0) {
      EXPECT_EQ(all[0].block, kCandidates - 1);
    }
    ++sent[all[0].block];
    age[all[0].block] = 0;
  }
  EXPECT_GT(sent[0], 0U);
  EXPECT_GT(sent[kCandidates - 1], 2 * sent[5]);
}

}  // namespace
}  // namespace gicodec
