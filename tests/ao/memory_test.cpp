// Cells and buckets under random motion: a client that is given what changed finds every point.
#include "ao/point_memory.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace gicodec::ao {
namespace {

using ddgi::Vec3;

/// What a client holds: blocks that it was sent, and no others.
struct Client {
  std::vector<PointMemory::Cell> cells;
  std::vector<PointMemory::Bucket> buckets;

  /// Takes the blocks that differ; returns how many cells those are.
  std::size_t update(const PointMemory& memory) {
    cells.resize(memory.cells().size());
    buckets.resize(memory.buckets().size());
    std::size_t changed = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      changed += cells[i] != memory.cells()[i];
      cells[i] = memory.cells()[i];
    }
    std::ranges::copy(memory.buckets(), buckets.begin());
    return changed;
  }
  /// The points of a cell, as the library finds it.
  [[nodiscard]] std::multiset<std::uint32_t> find(const AoGrid& grid, const Grid& cell) const {
    const auto slot = find_ao_cell(grid, cell, std::as_bytes(std::span(buckets)),
                                   static_cast<std::uint32_t>(cells.size()));
    std::multiset<std::uint32_t> points;
    if (!slot) return points;
    for (const std::uint32_t bits : cells[*slot]) {
      if (bits != 0) points.insert(bits);
    }
    return points;
  }
};

struct Point {
  std::size_t instance = 0;
  Grid cell{};
  std::optional<std::uint32_t> place;
  std::uint32_t bits = 0;
};

std::vector<AoGrid> two_grids(std::uint32_t buckets) {
  AoGrid a, b;
  a.cells = {4, 3, 2}, a.buckets = buckets;
  b.cells = {2, 5, 3}, b.buckets = buckets + 1;
  return {a, b};
}

Grid any_cell(const AoGrid& grid) {
  return {*rc::gen::inRange<std::uint32_t>(0, grid.cells.x),
          *rc::gen::inRange<std::uint32_t>(0, grid.cells.y),
          *rc::gen::inRange<std::uint32_t>(0, grid.cells.z)};
}

/// Every cell of every instance holds what its points are, and nothing else.
void expect_all_found(const PointMemory& memory, const Client& client,
                      const std::vector<Point>& points) {
  std::uint64_t held = 0;
  for (std::size_t i = 0; i < memory.grids().size(); ++i) {
    const AoGrid& grid = memory.grids()[i];
    for (std::uint32_t cell = 0; cell < grid.cells.x * grid.cells.y * grid.cells.z; ++cell) {
      const Grid at{cell % grid.cells.x, cell / grid.cells.x % grid.cells.y,
                    cell / (grid.cells.x * grid.cells.y)};
      std::multiset<std::uint32_t> expected;
      for (const Point& point : points) {
        if (point.instance == i && point.cell == at && point.place) expected.insert(point.bits);
      }
      held += expected.size();
      RC_ASSERT(client.find(grid, at) == expected);
    }
  }
  RC_ASSERT(memory.statistics().points == held);
}

RC_GTEST_PROP(PointMemory, ClientsOfWhatChangedFindEveryPoint, ()) {
  PointMemory memory(two_grids(*rc::gen::inRange<std::uint32_t>(1, 5)),
                     *rc::gen::inRange<std::uint32_t>(1, 60));
  std::vector<Point> points(*rc::gen::inRange<std::size_t>(0, 120));
  Client client;
  std::uint64_t refused = 0;
  std::uint32_t next = 1;
  const auto put = [&](Point& point) {
    point.bits = 2 * next++ + 1;
    point.place = memory.insert(point.instance, point.cell, point.bits);
    refused += !point.place;
  };
  for (Point& point : points) {
    point.instance = *rc::gen::inRange<std::size_t>(0, 2);
    point.cell = any_cell(memory.grids()[point.instance]);
    put(point);
  }
  client.update(memory);
  expect_all_found(memory, client, points);
  for (int update = 0; update < 5 && !points.empty(); ++update) {
    std::set<std::uint32_t> touched;
    const auto before = std::vector(memory.cells().begin(), memory.cells().end());
    const auto moves = *rc::gen::container<std::vector<std::size_t>>(
        rc::gen::inRange<std::size_t>(0, points.size()));
    for (const std::size_t i : moves) {
      Point& point = points[i];
      if (point.place) touched.insert(*point.place / kAoCellPoints);
      if (point.place && *rc::gen::arbitrary<bool>()) {
        point.bits = 2 * next++ + 1;
        memory.write(*point.place, point.bits);  // Within its cell: the place stays.
      } else {
        if (point.place) memory.remove(point.instance, point.cell, *point.place);
        point.cell = any_cell(memory.grids()[point.instance]);
        put(point);
        if (point.place) touched.insert(*point.place / kAoCellPoints);
      }
    }
    for (std::uint32_t cell = 0; cell < before.size(); ++cell) {
      if (before[cell] != memory.cells()[cell]) RC_ASSERT(touched.contains(cell));
    }
    RC_ASSERT(client.update(memory) <= touched.size());
    expect_all_found(memory, client, points);
    for (const Point& point : points) {
      if (point.place) RC_ASSERT(memory.read(*point.place) == point.bits);
    }
  }
  RC_ASSERT(memory.statistics().overflow() == refused);
}

TEST(PointMemory, CountsWhyPointsFoundNoPlace) {
  AoGrid grid;
  grid.cells = {20, 1, 1}, grid.buckets = 1;
  PointMemory memory({grid}, 9);
  for (std::size_t i = 0; i < kAoCellPoints; ++i) EXPECT_TRUE(memory.insert(0, {0, 0, 0}, 1));
  EXPECT_FALSE(memory.insert(0, {0, 0, 0}, 1));
  EXPECT_EQ(memory.statistics().full_cells, 1U);
  for (std::uint32_t x = 1; x < kAoBucketEntries; ++x) EXPECT_TRUE(memory.insert(0, {x, 0, 0}, 1));
  EXPECT_FALSE(memory.insert(0, {10, 0, 0}, 1));
  EXPECT_EQ(memory.statistics().full_buckets, 1U);

  grid.buckets = 4;
  PointMemory small({grid}, 3);
  for (std::uint32_t x = 0; x < 3; ++x) EXPECT_TRUE(small.insert(0, {x, 0, 0}, 1));
  EXPECT_FALSE(small.insert(0, {3, 0, 0}, 1));
  EXPECT_EQ(small.statistics().full_pool, 1U);
  EXPECT_EQ(small.statistics().overflow(), 1U);
}

TEST(PointMemory, TakesFreedCellsAgain) {
  AoGrid grid;
  grid.cells = {20, 1, 1}, grid.buckets = 5;
  PointMemory memory({grid}, 2);
  const auto first = memory.insert(0, {0, 0, 0}, 1), second = memory.insert(0, {1, 0, 0}, 1);
  ASSERT_TRUE(first && second);
  memory.remove(0, {0, 0, 0}, *first);
  EXPECT_EQ(memory.statistics().cells, 1U);
  const auto third = memory.insert(0, {7, 0, 0}, 3);
  ASSERT_TRUE(third);
  EXPECT_EQ(*third / kAoCellPoints, *first / kAoCellPoints);
  EXPECT_EQ(memory.statistics().overflow(), 0U);
  EXPECT_EQ(memory.read(*third), 3U);
}

TEST(PointMemory, HasNoPlaceOutsideOfAGrid) {
  AoGrid grid;
  grid.origin = {1, 2, 3}, grid.cell = 0.5F, grid.cells = {2, 2, 2};
  const auto place = place_in(grid, {1.75F, 2, 3.25F});
  ASSERT_TRUE(place);
  EXPECT_EQ(place->cell, (Grid{1, 0, 0}));
  EXPECT_EQ(place->within, (Position{0.5F, 0, 0.5F}));
  for (const Vec3 p : {Vec3{0.9F, 2, 3}, Vec3{2, 2, 3}, Vec3{1, 2, 1e30F}, Vec3{NAN, 2, 3}}) {
    EXPECT_FALSE(place_in(grid, p));
  }
}

}  // namespace
}  // namespace gicodec::ao
