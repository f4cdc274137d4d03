// Payloads of light at vertices and voxels (round_trip.h).
#include "native/round_trip.h"
#include "native/vector_content.h"
#include "native/voxel_content.h"
#include "shapes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace gicodec {
namespace {

using test::any_update;
using test::Bytes;
using test::check_everything;
using test::decode;

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
  if (!test::chance(random, 4)) settings.chunk.preset = native::Preset::strong;
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
  if (!test::chance(random, 4)) settings.chunk.preset = native::Preset::strong;
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
      const std::size_t size = block_bytes(desc), presence = presence_bytes(desc);
      test::Random random(side);
      Bytes mirror(block_count(desc) * size), existed(block_count(desc) * presence);
      std::vector<std::uint8_t> received(block_count(desc), 0);
      for (unsigned packet = 0; packet < 8; ++packet) {
        const auto now = test::make_voxels(desc, test::VoxelContent::crowded, packet, side);
        const bool intra = packet == 5;
        test::UpdateCase u{desc, {}, {}, {}, {}, packet == 0 || intra, {}, intra};
        for (std::uint32_t b = 0; b < block_count(desc); ++b) {
          if (!test::chance(random, 2)) continue;
          u.blocks.push_back(b);
          const auto block = std::span(now.records).subspan(b * size, size);
          const auto one = std::span(now.presence).subspan(b * presence, presence);
          u.records.insert(u.records.end(), block.begin(), block.end());
          u.presence.insert(u.presence.end(), one.begin(), one.end());
        }
        if (packet > 0) {
          u.mirror = mirror;
          u.mirror_presence = existed;
          u.received = received;
        }
        native::PayloadSettings settings;
        settings.chunk.preset = native::Preset::strong;
        if (packet % 3 == 2) settings.box = {4, 1, 1};
        check_everything(u, settings);
        for (const std::uint32_t b : u.blocks) {
          std::memcpy(&mirror[b * size], &now.records[b * size], size);
          std::memcpy(&existed[b * presence], &now.presence[b * presence], presence);
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
        settings.chunk.preset = native::Preset::strong;
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

/// Light is coded by the model of vertices, also without vertices around.
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

}  // namespace
}  // namespace gicodec
