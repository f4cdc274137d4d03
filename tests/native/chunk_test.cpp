// Chunks: every probe once, neighbours in earlier groups, the same for any subset.
#include "native/frame/chunk.h"
#include "support.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <optional>
#include <set>

namespace gicodec::native {
namespace {

/// An update of some probes of a grid that is cut into boxes; of the others some were received.
struct AnyUpdate {
  explicit AnyUpdate(std::uint64_t seed) : random(seed) {
    grid = {test::pick(random, 1, 9), test::pick(random, 1, 9), test::pick(random, 1, 9)};
    box = {test::pick(random, 1, grid.x), test::pick(random, 1, grid.y),
           test::pick(random, 1, grid.z)};
    for (std::uint32_t p = 0; p < grid.x * grid.y * grid.z; ++p) {
      if (!test::chance(random, 3)) probes.push_back(p);
    }
    received.resize(std::size_t{grid.x} * grid.y * grid.z);
    for (auto& flag : received) flag = static_cast<std::uint8_t>(!test::chance(random, 3));
    held = test::chance(random, 2);
    lanes = 1U << test::pick(random, 0, 5);
    split(grid, chunk_grid(grid, box), probes, lists);
  }
  [[nodiscard]] const MirrorView* mirror() const { return held ? &view : nullptr; }
  [[nodiscard]] std::span<const std::uint32_t> positions(std::size_t c) const {
    return std::span(lists.position).subspan(lists.begin[c], lists.begin[c + 1] - lists.begin[c]);
  }
  /// The probe at −1 along an axis if it lies in the same box, or nothing.
  [[nodiscard]] std::optional<std::uint32_t> neighbour(std::uint32_t probe, unsigned axis) const {
    const std::uint32_t coordinate[3] = {probe % grid.x % box.x, probe / grid.x % grid.y % box.y,
                                         probe / grid.x / grid.y % box.z};
    const std::uint32_t step[3] = {1, grid.x, grid.x * grid.y};
    if (coordinate[axis] == 0) return {};
    return probe - step[axis];
  }
  test::Random random;
  Grid grid, box;
  std::vector<std::uint32_t> probes;
  std::vector<std::uint8_t> received;
  MirrorView view{{}, nullptr};
  bool held;
  unsigned lanes;
  ChunkLists lists;
};

RC_GTEST_PROP(NativeChunk, GroupsRespectNeighbours, (std::uint64_t seed)) {
  AnyUpdate u(seed);
  u.view.received = u.received.data();
  std::set<std::uint32_t> seen;
  Chunk chunk;
  for (std::size_t c = 0; c < u.lists.chunk.size(); ++c) {
    const auto positions = u.positions(c);
    chunk.build(u.grid, u.box, u.probes, positions, u.mirror(), u.lanes);
    RC_ASSERT(chunk.coded == positions.size());
    std::uint32_t widest = 0;
    for (std::size_t g = 0; g + 1 < chunk.group_begin.size(); ++g) {
      const std::uint32_t begin = chunk.group_begin[g], end = chunk.group_begin[g + 1];
      RC_ASSERT(begin < end);
      RC_ASSERT(end - begin <= u.lanes);
      widest = std::max(widest, end - begin);
      for (std::uint32_t b = begin; b < end; ++b) {
        const auto& block = chunk.blocks[b];
        RC_ASSERT(u.probes[block.position] == block.probe);
        RC_ASSERT(seen.insert(block.probe).second);
        for (unsigned axis = 0; axis < 3; ++axis) {
          const std::int32_t n = block.neighbour[axis];
          const auto probe = u.neighbour(block.probe, axis);
          if (!probe) {
            RC_ASSERT(n == kNoBlock);
          } else if (n == kNoBlock) {
            RC_ASSERT(!u.held || u.received[*probe] == 0);
            RC_ASSERT(!std::ranges::binary_search(u.probes, *probe));
          } else {
            RC_ASSERT(chunk.blocks[n].probe == *probe);
            RC_ASSERT(n < static_cast<std::int32_t>(begin) ||
                      n >= static_cast<std::int32_t>(chunk.coded));
            RC_ASSERT(n < static_cast<std::int32_t>(chunk.coded) || u.received[*probe] != 0);
          }
        }
      }
    }
    RC_ASSERT(chunk.widest_group() == widest);
    // Groups formed anew are those of a chunk that is built so.
    Chunk other;
    other.build(u.grid, u.box, u.probes, positions, u.mirror(), kLanes);
    other.form_groups(u.lanes);
    RC_ASSERT(other.group_begin == chunk.group_begin);
  }
  RC_ASSERT(seen == std::set<std::uint32_t>(u.probes.begin(), u.probes.end()));
}

/// Flat chunks: full groups in the order given, neighbours by what was received alone.
RC_GTEST_PROP(NativeChunk, FlatGroupsAreFull, (std::uint64_t seed)) {
  AnyUpdate u(seed);
  u.view.received = u.received.data();
  const bool previous = seed % 2 == 0;
  std::size_t seen = 0;
  Chunk chunk;
  for (std::size_t c = 0; c < u.lists.chunk.size(); ++c) {
    const auto positions = u.positions(c);
    chunk.build_flat(u.grid, u.box, u.probes, positions, u.mirror(), previous, u.lanes);
    RC_ASSERT(chunk.coded == positions.size());
    Vector<std::uint32_t> begins;
    for (std::uint32_t b = 0; b < chunk.coded; b += u.lanes) begins.push_back(b);
    begins.push_back(chunk.coded);
    RC_ASSERT(chunk.group_begin == begins);
    std::set<std::uint32_t> only_held;
    for (std::size_t b = chunk.coded; b < chunk.blocks.size(); ++b) {
      RC_ASSERT(only_held.insert(chunk.blocks[b].probe).second);
    }
    for (std::uint32_t b = 0; b < chunk.coded; ++b, ++seen) {
      const auto& block = chunk.blocks[b];
      RC_ASSERT(block.position == positions[b]);
      RC_ASSERT(block.probe == u.probes[block.position]);
      for (unsigned axis = 0; axis < 3; ++axis) {
        const std::int32_t n = block.neighbour[axis];
        const auto probe = u.neighbour(block.probe, axis);
        const bool known = probe && u.held && u.received[*probe] != 0 &&
                           (previous || !std::ranges::binary_search(u.probes, *probe));
        RC_ASSERT((n != kNoBlock) == known);
        if (!known) continue;
        RC_ASSERT(n >= static_cast<std::int32_t>(chunk.coded));
        RC_ASSERT(chunk.blocks.at(static_cast<std::size_t>(n)).probe == *probe);
      }
    }
  }
  RC_ASSERT(seen == u.probes.size());
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
