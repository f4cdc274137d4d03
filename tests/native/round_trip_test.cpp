// Payloads: exact for everything, the same bytes on every instruction set and number of threads,
// and what the reference decoder reads.
#include "native/content.h"
#include "native/reference_decoder.h"
#include "native/vector_content.h"
#include "native/voxel_content.h"
#include "quantise/set_order.h"
#include "shapes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numeric>

namespace gicodec {
namespace {

using test::Bytes;

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

Bytes decode(const test::UpdateCase& u, std::span<const std::byte> payload, unsigned threads,
             Isa isa) {
  const test::Exact exact(payload), mirror(u.mirror);
  test::Exact out(u.records.size());
  native::PayloadMemory memory;
  auto job = u.decode_job(exact.span(), out.span());
  job.mirror.blocks.records = mirror.span().data();
  job.threads = threads;
  EXPECT_EQ(native::decode_payload(job, isa, memory), Status::ok);
  return {out.span().begin(), out.span().end()};
}

void check_everything(test::UpdateCase u, native::PayloadSettings settings) {
  SCOPED_TRACE(rc::toString(u.desc) + (u.intra ? " intra" : u.keyframe ? " keyframe" : " update"));
  const Bytes payload = test::encode(u, settings, Isa::scalar);
  EXPECT_LE(payload.size(), native::payload_bound(u.desc, u.blocks.size()));
  static unsigned turn = 0;
  const bool all = test::everything();
  const auto isas = supported_isas();
  for (const Isa isa : all ? isas : isas.subspan(turn++ % isas.size(), 1)) {
    SCOPED_TRACE(to_string(isa));
    for (const unsigned threads : {1U, 2U, 7U}) {
      if (threads > 1 && (isa != best_isa() || (!all && threads != (turn % 8 < 4 ? 2 : 7))))
        continue;
      settings.threads = threads;
      EXPECT_EQ(test::encode(u, settings, isa), payload);
      EXPECT_EQ(decode(u, payload, threads, isa), u.records);
    }
  }
  const auto expected = reference::decode(u.desc, u.blocks, u.mirror, u.received, payload,
                                          u.presence, u.intra, u.mirror_presence);
  ASSERT_TRUE(expected.has_value());
  EXPECT_EQ(*expected, u.records);
}

test::UpdateCase any_update(const TextureDesc& desc, test::Content content, std::uint32_t one_in,
                            std::uint64_t seed) {
  if (seed % 4 == 0) return test::make_intra(desc, content, one_in, seed);
  return test::make_update(desc, content, seed % 4 == 1, one_in, seed);
}

RC_GTEST_PROP(NativeRoundTrip, AnyTexture, (std::uint64_t seed)) {
  test::Random random(seed);
  const auto desc = small_desc(random);
  const auto content = test::kContents[random() % std::size(test::kContents)];
  native::PayloadSettings settings;
  settings.chunk.strong = test::chance(random, 4);
  if (test::chance(random, 2)) {
    settings.box = {test::pick(random, 1, desc.grid.x), test::pick(random, 1, desc.grid.y),
                    test::pick(random, 1, desc.grid.z)};
  }
  if (test::chance(random, 3)) settings.chunk.lanes = 1U << test::pick(random, 0, 5);
  check_everything(any_update(desc, content, test::pick(random, 1, 4), seed), settings);
  RC_ASSERT(!testing::Test::HasFailure());
}

TEST(NativeRoundTrip, EveryFormatAndContent) {
  test::Sweep sweep;
  for (const auto& format : formats()) {
    const TextureDesc desc = probe_texture(format.record, {6, 4, 5}, 6, 1);
    for (const auto content : test::kContents) {
      for (const bool keyframe : {true, false}) {
        if (!sweep.takes()) continue;
        check_everything(test::make_update(desc, content, keyframe, 1, 5), {});
      }
    }
  }
}

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
    const auto bytes = [](const auto& u) { return test::encode(u, {}, best_isa()).size(); };
    EXPECT_LT(bytes(intra), bytes(keyframe));
  }
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
  settings.chunk.strong = test::chance(random, 4);
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
  settings.chunk.strong = test::chance(random, 4);
  check_everything(any_update(desc, content, test::pick(random, 1, 3), seed), settings);
  RC_ASSERT(!testing::Test::HasFailure());
}

TextureDesc any_sets(test::Random& random, const Record& record) {
  TextureDesc desc = pool_texture(record, test::pick(random, 1, 12), {1, 1, 1});
  desc.model = Model::unordered;
  desc.presence = test::chance(random, 2) ? Presence::count : Presence::all;
  desc.block = {static_cast<std::uint8_t>(test::pick(random, 1, 40)),
                static_cast<std::uint8_t>(test::pick(random, 1, 4)), 1};
  return desc;
}

/// Blocks that are sets, in the canonical order or in any.
RC_GTEST_PROP(NativeRoundTrip, AnySet, (std::uint64_t seed)) {
  test::Random random(seed);
  const TextureDesc desc = any_sets(random, test::any_record(random));
  ASSERT_EQ(validate(desc), Status::ok);
  const auto content = test::kContents[random() % std::size(test::kContents)];
  auto u = any_update(desc, content, test::pick(random, 1, 3), seed);
  if (!test::chance(random, 4)) test::sort_sets(u);
  check_everything(u, {});
  RC_ASSERT(!testing::Test::HasFailure());
}

/// Blocks that are sets, of which the mirror has a part.
RC_GTEST_PROP(NativeRoundTrip, AnyUpdateOfSets, (std::uint64_t seed)) {
  test::Random random(seed);
  const TextureDesc desc = any_sets(random, test::any_record(random));
  const auto content = test::kContents[random() % std::size(test::kContents)];
  auto u = test::make_update(desc, content, false, test::pick(random, 1, 3), seed);
  if (!test::chance(random, 6)) test::sort_sets(u);
  test::make_past(u, random, !test::chance(random, 6));
  check_everything(u, {});
  RC_ASSERT(!testing::Test::HasFailure());
}

/// Photons, as it were: many on walls.
test::UpdateCase points_on_walls(std::uint32_t count, bool sorted) {
  Record record;
  record.bytes = 12;
  for (const auto& [name, bits] :
       {std::pair("x", 16), {"y", 16}, {"z", 16}, {"u", 16}, {"p", 32}}) {
    const unsigned at = record.count == 0 ? 0
                                          : record.components[record.count - 1U].offset +
                                                record.components[record.count - 1U].bits;
    record.components[record.count++] = {name, static_cast<std::uint16_t>(at),
                                         static_cast<std::uint8_t>(bits), ComponentKind::unorm};
  }
  TextureDesc desc = pool_texture(record, 1, {64, 64, 1});
  desc.model = Model::unordered;
  desc.presence = Presence::count;
  test::UpdateCase u{desc, {0}, Bytes(block_bytes(desc)), {}, {}, true, {}, false};
  u.presence = {std::byte(count & 255), std::byte(count >> 8)};
  test::Random random(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<std::uint16_t, 6> p{};
    for (auto& v : p) v = static_cast<std::uint16_t>(random());
    p[random() % 3] = static_cast<std::uint16_t>(random() % 3 * 20000);
    p[4] = p[5] = 77;
    std::memcpy(u.records.data() + i * sizeof p, p.data(), sizeof p);
  }
  if (sorted) test::sort_sets(u);
  return u;
}

/// Two coordinates of 16 bits, less log2(n!)/n bits for the order, 16 bits of noise, nothing else.
TEST(NativeRoundTrip, SetsCostWhatTheirPlacesAre) {
  for (const std::uint32_t count : {0U, 1U, 2U, 3U, 100U, 4096U}) {
    check_everything(points_on_walls(count, true), {});
    check_everything(points_on_walls(count, false), {});
  }
  const double ideal = 4096 * (32 + 1.58 - 10.56 + 16 + 1.58) / 8;
  const auto size =
      static_cast<double>(test::encode(points_on_walls(4096, true), {}, best_isa()).size());
  EXPECT_LE(size, 1.15 * ideal);
}

/// What is still there costs a flag, and nothing where there is nothing.
TEST(NativeRoundTrip, UpdatesOfSetsCostWhatIsNew) {
  const auto size = [](const test::UpdateCase& u) {
    return static_cast<double>(test::encode(u, {}, best_isa()).size());
  };
  constexpr std::size_t kCount = 4096, kRecord = 12;
  const auto key = points_on_walls(kCount, true);
  auto u = key;
  u.keyframe = false;
  u.received = {1};
  u.mirror = points_on_walls(kCount - 1, true).records;
  EXPECT_LE(size(u), 1.001 * size(key) + 2);
  check_everything(u, {});

  u.mirror = u.records;
  EXPECT_LE(size(u), 16);
  test::Random random(1);
  for (std::size_t i = 0; i < kCount; i += 16) {
    u.mirror[i * kRecord + 6] ^= std::byte{1};  // behind its place
    std::generate_n(&u.mirror[(i + 8) * kRecord], 6,
                    [&] { return static_cast<std::byte>(random()); });
  }
  sort_set(u.desc.record, u.mirror);
  EXPECT_LE(size(u), size(key) / 8);
  check_everything(u, {});
}

TEST(NativeRoundTrip, SetsOfOneAndTheSame) {
  for (const bool zero : {true, false}) {
    auto u = points_on_walls(500, true);
    for (std::size_t i = 0; i < 500 * 12; ++i)
      u.records[i] = zero ? std::byte{0} : u.records[i % 12];
    check_everything(u, {});
    EXPECT_LE(test::encode(u, {}, best_isa()).size(), 200U);
    std::fill_n(u.records.begin() + 12 * 100, 12 * 400, std::byte{0});
    test::sort_sets(u);
    check_everything(u, {});
  }
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
  settings.chunk.strong = true;
  check_everything(any_update(desc, content, test::pick(random, 1, 4), seed), settings);
  RC_ASSERT(!testing::Test::HasFailure());
}

constexpr Grid kVertexGrids[] = {{1, 1, 1}, {5, 1, 1}, {3, 4, 5}, {9, 7, 6}};

TEST(NativeRoundTrip, VerticesOfEveryContent) {
  test::Sweep sweep;
  for (const Grid& grid : kVertexGrids) {
    for (const bool floats : {false, true}) {
      const auto desc = test::vertices(grid, floats);
      for (const auto content : test::kVertexContents) {
        for (const auto mode : test::kUpdateModes) {
          for (const std::uint32_t one_in : {1U, 3U}) {
            // The reference decoder takes its time.
            const bool large = grid.x == 9 || (grid.x == 3 && one_in == 1);
            if (large && content != test::VertexContent::integrated) continue;
            if (grid.x == 9 && one_in == 1) continue;
            if (!sweep.takes()) continue;
            const auto u = test::make_vertex_update(desc, content, mode, one_in, grid.x + one_in);
            check_everything(u, {});
          }
        }
      }
    }
  }
}

/// Also in boxes of any size.
RC_GTEST_PROP(NativeRoundTrip, AnyVertices, (std::uint64_t seed)) {
  test::Random random(seed);
  const Grid grid{test::pick(random, 1, 6), test::pick(random, 1, 4), test::pick(random, 1, 4)};
  const auto desc = test::vertices(grid, test::chance(random, 2));
  native::PayloadSettings settings;
  settings.chunk.strong = !test::chance(random, 4);
  if (test::chance(random, 2)) {
    settings.box = {test::pick(random, 1, grid.x), test::pick(random, 1, grid.y),
                    test::pick(random, 1, grid.z)};
  }
  const std::uint32_t one_in = test::pick(random, 1, 4);
  if (test::chance(random, 4)) {
    const auto content = test::kContents[random() % std::size(test::kContents)];
    check_everything(any_update(desc, content, one_in, seed), settings);
  } else {
    const auto content = test::kVertexContents[random() % std::size(test::kVertexContents)];
    const auto mode = test::kUpdateModes[random() % std::size(test::kUpdateModes)];
    check_everything(test::make_vertex_update(desc, content, mode, one_in, seed), settings);
  }
  RC_ASSERT(!testing::Test::HasFailure());
}

TEST(NativeRoundTrip, VoxelsOfEveryContent) {
  test::Sweep sweep;
  for (const std::uint8_t side : {std::uint8_t{2}, std::uint8_t{4}, std::uint8_t{8}}) {
    for (const bool halves : {false, true}) {
      const auto desc = test::voxels(side == 2 ? 40 : side == 4 ? 10 : 3, side, halves);
      for (const auto content : test::kVoxelContents) {
        for (const auto mode : test::kUpdateModes) {
          if (!sweep.takes()) continue;
          const std::uint32_t one_in = side == 4 ? 3 : 1;
          check_everything(test::make_voxel_update(desc, content, mode, one_in, side), {});
        }
      }
    }
  }
}

/// Also in boxes of any size.
RC_GTEST_PROP(NativeRoundTrip, AnyVoxels, (std::uint64_t seed)) {
  test::Random random(seed);
  const auto side = static_cast<std::uint8_t>(1U << test::pick(random, 1, 3));
  const std::uint32_t most = side == 2 ? 100 : side == 4 ? 20 : 4;
  const auto desc = test::voxels(test::pick(random, 1, most), side, test::chance(random, 2));
  native::PayloadSettings settings;
  settings.chunk.strong = !test::chance(random, 4);
  if (test::chance(random, 4)) settings.box = {test::pick(random, 1, desc.grid.x), 1, 1};
  const auto content = test::kVoxelContents[random() % std::size(test::kVoxelContents)];
  const auto mode = test::kUpdateModes[random() % std::size(test::kUpdateModes)];
  check_everything(test::make_voxel_update(desc, content, mode, test::pick(random, 1, 3), seed),
                   settings);
  RC_ASSERT(!testing::Test::HasFailure());
}

/// What a client holds after any packets: bricks that come, change, move and go, their parents
/// first or long before.
TEST(NativeRoundTrip, VoxelsInSparsePackets) {
  for (const std::uint8_t side : {std::uint8_t{2}, std::uint8_t{4}, std::uint8_t{8}}) {
    for (const bool halves : {false, true}) {
      const TextureDesc desc = test::voxels(side == 8 ? 5 : 20, side, halves);
      const std::size_t size = block_bytes(desc), said = presence_bytes(desc);
      test::Random random(side);
      Bytes mirror(block_count(desc) * size), existed(block_count(desc) * said);
      std::vector<std::uint8_t> received(block_count(desc), 0);
      for (unsigned packet = 0; packet < 8; ++packet) {
        const auto now = test::make_voxels(desc, test::VoxelContent::crowded, packet, side);
        const bool intra = packet == 5;
        test::UpdateCase u{desc, {}, {}, {}, {}, packet == 0 || intra, {}, intra};
        for (std::uint32_t b = 0; b < block_count(desc); ++b) {
          if (!test::chance(random, 2)) continue;
          u.blocks.push_back(b);
          const auto block = std::span(now.records).subspan(b * size, size);
          const auto one = std::span(now.presence).subspan(b * said, said);
          u.records.insert(u.records.end(), block.begin(), block.end());
          u.presence.insert(u.presence.end(), one.begin(), one.end());
        }
        if (packet > 0) {
          u.mirror = mirror;
          u.mirror_presence = existed;
          u.received = received;
        }
        native::PayloadSettings settings;
        settings.chunk.strong = true;
        if (packet % 3 == 2) settings.box = {4, 1, 1};
        check_everything(u, settings);
        for (const std::uint32_t b : u.blocks) {
          std::memcpy(&mirror[b * size], &now.records[b * size], size);
          std::memcpy(&existed[b * said], &now.presence[b * said], said);
          received[b] = 1;
        }
      }
    }
  }
}

/// A volume that comes and changes bit by bit.
TEST(NativeRoundTrip, VerticesInSparsePackets) {
  for (const bool floats : {false, true}) {
    for (const auto content : test::kVertexContents) {
      const auto desc = test::vertices({6, 5, 4}, floats);
      const std::size_t size = block_bytes(desc);
      test::Random random(floats ? 3 : 4);
      Bytes mirror(block_count(desc) * size);
      std::vector<std::uint8_t> received(block_count(desc), 0);
      for (unsigned packet = 0; packet < 8; ++packet) {
        const Bytes now = test::make_vertices(desc, content, packet, 5);
        test::UpdateCase u{desc, {}, {}, {}, {}, packet == 0, {}};
        for (std::uint32_t b = 0; b < block_count(desc); ++b) {
          if (!test::chance(random, 5)) continue;
          u.blocks.push_back(b);
          const auto block = std::span(now).subspan(b * size, size);
          u.records.insert(u.records.end(), block.begin(), block.end());
        }
        if (packet > 0) {
          u.mirror = mirror;
          u.received = received;
        }
        native::PayloadSettings settings;
        settings.chunk.strong = true;
        if (packet % 3 == 2) settings.box = {4, 3, 4};
        check_everything(u, settings);
        for (const std::uint32_t b : u.blocks) {
          std::memcpy(&mirror[b * size], &now[b * size], size);
          received[b] = 1;
        }
      }
    }
  }
}

TEST(NativeRoundTrip, VerticesOnAnyThreads) {
  for (const auto mode : test::kUpdateModes) {
    const auto u = test::make_vertex_update(test::vertices({9, 7, 6}, false),
                                            test::VertexContent::integrated, mode, 2, 3);
    native::PayloadSettings settings;
    settings.box = {4, 3, 4};
    settings.threads = 1;
    const Bytes payload = test::encode(u, settings, best_isa());
    for (const unsigned threads : {2U, 3U, 7U}) {
      settings.threads = threads;
      EXPECT_EQ(test::encode(u, settings, best_isa()), payload);
      EXPECT_EQ(decode(u, payload, threads, best_isa()), u.records);
    }
  }
}

/// Light is coded by the model of vertices, also what no vertex around tells of.
TEST(NativeRoundTrip, VerticesAreCodedAdaptively) {
  for (const bool floats : {false, true}) {
    const auto desc = test::vertices({9, 7, 6}, floats);
    for (const auto content : {test::VertexContent::smooth, test::VertexContent::integrated}) {
      for (const auto mode : test::kUpdateModes) {
        const auto u = test::make_vertex_update(desc, content, mode, 1, 7);
        const Bytes payload = test::encode(u, {}, best_isa());
        native::PayloadMemory memory;
        ASSERT_EQ(native::check_payload(desc, u.blocks.size(), payload, memory), Status::ok);
        for (const auto& chunk : memory.head.chunks) EXPECT_EQ(chunk.front(), std::byte{2});
        EXPECT_LT(payload.size(), u.records.size());
      }
    }
  }
}

TEST(NativeRoundTrip, EveryFormatInPart) {
  test::Sweep sweep;
  for (const auto& format : formats()) {
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
                                     ComponentKind::uint};
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
  for (const auto& format : formats()) {
    const TextureDesc desc = probe_texture(format.record, {7, 5, 6}, 8, 1);
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
