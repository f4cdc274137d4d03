// AO points as values and as bits, and the hash table that finds their cells.
#include <gicodec/ao_points.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <tuple>
#include <vector>

namespace gicodec {
namespace {

constexpr std::size_t kBucketBytes = 8 * kAoBucketEntries;

float any_float() {
  const auto bits = *rc::gen::arbitrary<std::uint32_t>();
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}
Position any_position() { return {any_float(), any_float(), any_float()}; }

std::vector<std::byte> any_bytes(std::size_t size) {
  const auto bytes =
      *rc::gen::container<std::vector<std::uint8_t>>(size, rc::gen::arbitrary<std::uint8_t>());
  std::vector<std::byte> out(size);
  if (size > 0) std::memcpy(out.data(), bytes.data(), size);
  return out;
}

TEST(AoPoint, EveryPlaceComesBack) {
  for (std::uint32_t code = 0; code < 1U << 15; ++code) {
    const std::uint32_t bits = 1U | code << 1;
    const auto point = unpack_ao_point(bits);
    ASSERT_TRUE(point);
    ASSERT_EQ(pack_ao_point(*point) & 0xFFFFU, bits) << code;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(point->place[axis], (static_cast<float>(code >> 5 * axis & 31) + 0.5F) / 32);
    }
  }
}

TEST(AoPoint, EveryVisibilityComesBack) {
  for (std::uint32_t visible = 0; visible < 256; ++visible) {
    const std::uint32_t bits = with_visible(0xABCDEFU, static_cast<std::uint8_t>(visible));
    EXPECT_EQ(bits & 0xFFFFFFU, 0xABCDEFU);
    const auto point = unpack_ao_point(bits);
    ASSERT_TRUE(point);
    EXPECT_EQ(point->visible, visible);
    EXPECT_EQ(pack_ao_point(*point) >> 24, visible);
  }
}

TEST(AoPoint, EveryNormalIsAUnitVectorAndComesBack) {
  for (std::uint32_t code = 0; code < 256; ++code) {
    const auto point = unpack_ao_point(1U | code << 16);
    ASSERT_TRUE(point);
    const auto [x, y, z] = point->normal;
    EXPECT_NEAR(std::sqrt(x * x + y * y + z * z), 1, 1e-6) << code;
    // Codes of one normal, at the folded edges and -8, become the same one.
    const auto again = unpack_ao_point(pack_ao_point(*point));
    ASSERT_TRUE(again);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(again->normal[axis], point->normal[axis], 1e-6) << code;
    }
    EXPECT_EQ(pack_ao_point(*again), pack_ao_point(*point));
  }
  const auto lowest = unpack_ao_point(1U | 0x88U << 16), next = unpack_ao_point(1U | 0x99U << 16);
  EXPECT_EQ(lowest->normal, next->normal);
}

TEST(AoPoint, AxesAreExact) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const float side : {1.0F, -1.0F}) {
      AoPoint point;
      point.normal = {0, 0, 0};
      point.normal[axis] = side;
      EXPECT_EQ(unpack_ao_point(pack_ao_point(point))->normal, point.normal);
    }
  }
}

RC_GTEST_PROP(AoPoint, IsNearWhatWasPacked, ()) {
  const auto unit = [] { return static_cast<float>(*rc::gen::inRange(0, 10001)) / 10000; };
  AoPoint point;
  point.place = {unit(), unit(), unit()};
  point.normal = {unit() - 0.5F, unit() - 0.5F, unit() - 0.5F};
  const auto [x, y, z] = point.normal;
  const float size = std::sqrt(x * x + y * y + z * z);
  RC_PRE(size > 0);
  for (float& axis : point.normal) axis /= size;
  point.visible = *rc::gen::arbitrary<std::uint8_t>();
  const auto out = unpack_ao_point(pack_ao_point(point));
  RC_ASSERT(out);
  RC_ASSERT(out->visible == point.visible);
  float cosine = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    RC_ASSERT(std::abs(out->place[axis] - point.place[axis]) <= 1.0F / 64 + 1e-6F);
    cosine += out->normal[axis] * point.normal[axis];
  }
  RC_ASSERT(cosine > std::cos(0.2F));
  // No other code is nearer.
  for (std::uint32_t code = 0; code < 256; ++code) {
    const Position other = unpack_ao_point(1U | code << 16)->normal;
    float near = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) near += other[axis] * point.normal[axis];
    RC_ASSERT(near <= cosine + 1e-6F);
  }
}

RC_GTEST_PROP(AoPoint, TakesAnything, ()) {
  AoPoint point;
  point.place = any_position();
  point.normal = any_position();
  point.visible = *rc::gen::arbitrary<std::uint8_t>();
  const auto out = unpack_ao_point(pack_ao_point(point));
  RC_ASSERT(out);
  RC_ASSERT(out->visible == point.visible);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float place = point.place[axis];
    if (!(place > 0)) RC_ASSERT(out->place[axis] == 0.5F / 32);
    if (place >= 1) RC_ASSERT(out->place[axis] == 31.5F / 32);
  }
}

RC_GTEST_PROP(AoPoint, IsNotThereWithoutItsBit, (std::uint32_t bits)) {
  RC_ASSERT(unpack_ao_point(bits).has_value() == ((bits & 1U) != 0));
}

RC_GTEST_PROP(AoEntry, ComesBack, ()) {
  const auto side = [] { return *rc::gen::inRange<std::uint32_t>(0, kMaxAoGridSide); };
  const AoEntry entry{{side(), side(), side()}, *rc::gen::inRange<std::uint32_t>(0, 1U << 24)};
  RC_ASSERT(unpack_ao_entry(pack_ao_entry(entry)) == entry);
}

RC_GTEST_PROP(AoEntry, HasNoBitsThatMeanNothing, (std::uint64_t bits)) {
  const auto entry = unpack_ao_entry(bits);
  RC_ASSERT(entry.has_value() == ((bits >> 39 & 1) != 0));
  if (entry) RC_ASSERT(pack_ao_entry(*entry) == bits);
}

RC_GTEST_PROP(AoGrid, KeepsItsBits, ()) {
  AoGrid grid;
  grid.origin = any_position();
  grid.cell = any_float(), grid.radius = any_float();
  const auto side = [] { return *rc::gen::inRange<std::uint32_t>(0, kMaxAoGridSide + 1); };
  grid.cells = {side(), side(), side()};
  const auto word = rc::gen::arbitrary<std::uint32_t>();
  grid.first_bucket = *word, grid.buckets = *word, grid.object = *word, grid.mesh = *word;
  std::array<std::byte, kAoGridBytes> bytes{}, again{};
  pack_ao_grid(grid, bytes);
  const AoGrid out = unpack_ao_grid(bytes);
  pack_ao_grid(out, again);
  RC_ASSERT(bytes == again);
  RC_ASSERT(out.cells == grid.cells && out.first_bucket == grid.first_bucket &&
            out.buckets == grid.buckets && out.object == grid.object && out.mesh == grid.mesh);
  RC_ASSERT(std::memcmp(&out.origin, &grid.origin, sizeof grid.origin) == 0);
  RC_ASSERT(std::memcmp(&out.radius, &grid.radius, sizeof grid.radius) == 0);
}

/// A grid and buckets of a random size.
AoGrid any_grid(std::uint32_t& buckets) {
  AoGrid grid;
  const auto side = [] {
    return *rc::gen::element<std::uint32_t>(1, 2, 7, 60, 1000, kMaxAoGridSide);
  };
  grid.cells = {side(), side(), side()};
  grid.buckets = *rc::gen::inRange<std::uint32_t>(1, 50);
  grid.first_bucket = *rc::gen::inRange<std::uint32_t>(0, 5);
  buckets = grid.first_bucket + grid.buckets + *rc::gen::inRange<std::uint32_t>(0, 5);
  return grid;
}
Grid any_cell(const AoGrid& grid) {
  return {*rc::gen::inRange<std::uint32_t>(0, grid.cells.x),
          *rc::gen::inRange<std::uint32_t>(0, grid.cells.y),
          *rc::gen::inRange<std::uint32_t>(0, grid.cells.z)};
}

RC_GTEST_PROP(AoHash, FindsEveryCellAndNoOther, ()) {
  std::uint32_t count = 0;
  const AoGrid grid = any_grid(count);
  std::vector<std::byte> buckets(count * kBucketBytes);
  std::vector<std::size_t> used(count);
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t> known;
  const auto cells = *rc::gen::inRange<std::uint32_t>(0, 200);
  for (std::uint32_t slot = 0; slot < cells; ++slot) {
    const Grid cell = any_cell(grid);
    // Equation 1, each factor reduced on its own.
    const std::uint64_t n = grid.buckets, dx = grid.cells.x, dy = grid.cells.y;
    const std::uint64_t hash =
        cell.x % n + cell.y % n * (dx * 17 % n) + cell.z % n * (dx % n * (dy * 31 % n) % n);
    const std::uint64_t bucket = grid.first_bucket + hash % n;
    RC_ASSERT(ao_bucket(grid, cell) == bucket);
    if (known.contains({cell.x, cell.y, cell.z}) || used[bucket] == kAoBucketEntries) continue;
    const std::uint64_t entry = pack_ao_entry({cell, slot});
    std::memcpy(&buckets[bucket * kBucketBytes + 8 * used[bucket]++], &entry, sizeof entry);
    known[{cell.x, cell.y, cell.z}] = slot;
  }
  for (const auto& [cell, slot] : known) {
    const auto [x, y, z] = cell;
    RC_ASSERT(find_ao_cell(grid, {x, y, z}, buckets, cells) == slot);
    RC_ASSERT(!find_ao_cell(grid, {x, y, z}, buckets, slot));
  }
  for (int i = 0; i < 20; ++i) {
    const Grid cell = any_cell(grid);
    const auto found = known.find({cell.x, cell.y, cell.z});
    RC_ASSERT(find_ao_cell(grid, cell, buckets, cells).has_value() == (found != known.end()));
  }
  RC_ASSERT(!find_ao_cell(grid, {grid.cells.x, 0, 0}, buckets, cells));
  RC_ASSERT(!find_ao_cell(grid, {0, ~0U, 0}, buckets, cells));
}

RC_GTEST_PROP(AoHash, TakesAnyGridAndBuckets, ()) {
  const auto bytes = any_bytes(kAoGridBytes);
  AoGrid grid = unpack_ao_grid(std::span(bytes).first<kAoGridBytes>());
  // Some of them nearly in order.
  if (*rc::gen::arbitrary<bool>()) {
    const Grid all{kMaxAoGridSide, kMaxAoGridSide, kMaxAoGridSide};
    grid.cells = all;
    grid.first_bucket %= 4;
  }
  const auto count = *rc::gen::inRange<std::size_t>(0, 6);
  const auto buckets = any_bytes(count * kBucketBytes);
  const auto cells = *rc::gen::arbitrary<std::uint32_t>();
  const auto word = rc::gen::arbitrary<std::uint32_t>();
  const Grid cell = *rc::gen::arbitrary<bool>() ? Grid{*word, *word, *word}
                                                : Grid{*word % 9, *word % 9, *word % 9};
  const auto slot = find_ao_cell(grid, cell, buckets, cells);
  if (slot) RC_ASSERT(*slot < cells);
}

TEST(AoPoints, BucketsNameTheCellsOfTheirEntries) {
  const auto volume = ao_point_volume(100, 10, 2);
  ASSERT_TRUE(volume.ok());
  const TextureGroup& buckets = volume->groups[1];
  EXPECT_EQ(buckets.depends_on, 0);
  std::array<std::uint64_t, kAoBucketEntries> bucket{};
  bucket[1] = pack_ao_entry({{1, 2, 3}, 77});
  bucket[3] = 12;  // Not used.
  bucket[6] = pack_ao_entry({{8191, 0, 8191}, (1U << 24) - 1});
  std::vector<std::uint32_t> out(4);
  EXPECT_EQ(buckets.dependencies(std::as_bytes(std::span(bucket)), out), 2U);
  EXPECT_EQ(out[0], 77U);
  EXPECT_EQ(out[1], (1U << 24) - 1);
  out = {5};
  EXPECT_EQ(buckets.dependencies(std::as_bytes(std::span(bucket)), out), 2U);
  EXPECT_EQ(buckets.dependencies(std::as_bytes(std::span(bucket)), {}), 2U);
}

TEST(AoPoints, SizesThatNoPoolHasAreRefused) {
  EXPECT_EQ(ao_point_volume(0, 1, 1).status(), Status::invalid_description);
  EXPECT_EQ(ao_point_volume(1, 0, 1).status(), Status::invalid_description);
  EXPECT_EQ(ao_point_volume(1, 1, 0).status(), Status::invalid_description);
  EXPECT_EQ(ao_point_volume(kMaxBlocks + 1, 1, 1).status(), Status::invalid_description);
  EXPECT_TRUE(ao_point_volume(kMaxBlocks, kMaxBlocks, kMaxBlocks).ok());
}

}  // namespace
}  // namespace gicodec
