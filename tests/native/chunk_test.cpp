// Chunks: every probe once, neighbours in earlier groups, the same for any subset.
#include "native/chunk.h"
#include "support.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace gicodec::native {
namespace {

RC_GTEST_PROP(NativeChunk, GroupsRespectNeighbours, (std::uint64_t seed)) {
  test::Random random(seed);
  const Grid grid = {test::pick(random, 1, 9), test::pick(random, 1, 9), test::pick(random, 1, 9)};
  const Grid box = {test::pick(random, 1, grid.x), test::pick(random, 1, grid.y),
                    test::pick(random, 1, grid.z)};
  std::vector<std::uint32_t> probes;
  for (std::uint32_t p = 0; p < grid.x * grid.y * grid.z; ++p) {
    if (!test::chance(random, 3)) probes.push_back(p);
  }
  const bool update = test::chance(random, 2);
  std::vector<std::uint8_t> received(std::size_t{grid.x} * grid.y * grid.z);
  for (auto& flag : received) flag = static_cast<std::uint8_t>(!test::chance(random, 3));
  const MirrorView mirror{{}, received.data()};
  const unsigned lanes = 1U << test::pick(random, 0, 5);
  const ChunkGrid chunks = chunk_grid(grid, box);
  ChunkLists lists;
  split(grid, chunks, probes, lists);
  std::set<std::uint32_t> seen;
  Chunk chunk;
  for (std::size_t c = 0; c < lists.chunk.size(); ++c) {
    const auto positions =
        std::span(lists.position).subspan(lists.begin[c], lists.begin[c + 1] - lists.begin[c]);
    chunk.build(grid, box, probes, positions, update ? &mirror : nullptr, lanes);
    RC_ASSERT(chunk.coded == positions.size());
    for (std::size_t g = 0; g + 1 < chunk.group_begin.size(); ++g) {
      const std::uint32_t begin = chunk.group_begin[g], end = chunk.group_begin[g + 1];
      RC_ASSERT(begin < end);
      RC_ASSERT(end - begin <= lanes);
      for (std::uint32_t b = begin; b < end; ++b) {
        const auto& block = chunk.blocks[b];
        RC_ASSERT(probes[block.position] == block.probe);
        RC_ASSERT(seen.insert(block.probe).second);
        const std::uint32_t coordinate[3] = {block.probe % grid.x % box.x,
                                             block.probe / grid.x % grid.y % box.y,
                                             block.probe / grid.x / grid.y % box.z};
        const std::uint32_t step[3] = {1, grid.x, grid.x * grid.y};
        for (unsigned axis = 0; axis < 3; ++axis) {
          const std::int32_t n = block.neighbour[axis];
          if (coordinate[axis] == 0) {
            RC_ASSERT(n == kNoBlock);
          } else if (n == kNoBlock) {
            RC_ASSERT(!update || received[block.probe - step[axis]] == 0);
            RC_ASSERT(!std::ranges::binary_search(probes, block.probe - step[axis]));
          } else {
            RC_ASSERT(chunk.blocks[n].probe == block.probe - step[axis]);
            RC_ASSERT(n < static_cast<std::int32_t>(begin) ||
                      n >= static_cast<std::int32_t>(chunk.coded));
            RC_ASSERT(n < static_cast<std::int32_t>(chunk.coded) ||
                      received[block.probe - step[axis]] != 0);
          }
        }
      }
    }
  }
  RC_ASSERT(seen == std::set<std::uint32_t>(probes.begin(), probes.end()));
}

TEST(NativeChunk, DefaultBoxesAreValidAndSmallEnough) {
  for (const Grid grid :
       {Grid{1, 1, 1}, Grid{16, 8, 16}, Grid{32, 4, 64}, Grid{65535, 1, 256}, Grid{7, 11, 13}}) {
    for (const std::uint32_t target : {1U, 64U, 512U, 1024U}) {
      const Grid box = default_box(grid, target);
      EXPECT_TRUE(valid_box(grid, box));
      EXPECT_LE(box.x * box.y * box.z, target);
    }
  }
}

}  // namespace
}  // namespace gicodec::native
