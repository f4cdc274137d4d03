// Filling what has not arrived (Pacanowski et al. §4.1).
#include "vectors/push_pull.h"
#include "fields.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace gicodec::vectors {
namespace {

constexpr std::array kGrids{Grid{1, 1, 1}, Grid{2, 1, 5}, Grid{7, 5, 3},  Grid{8, 8, 8},
                            Grid{9, 1, 1}, Grid{1, 6, 2}, Grid{5, 17, 4}, Grid{16, 3, 1}};

/// check(field, smooth) for fields of all sizes, and hardly anything or nearly all known.
template <typename Check>
void for_fields(const Check& check) {
  for (const Grid& grid : kGrids) {
    for (const float share : {0.0F, 0.1F, 0.5F, 0.95F, 1.0F}) {
      for (std::uint32_t seed = 1; seed < 4; ++seed) {
        for (const bool smooth : {false, true}) {
          SCOPED_TRACE(testing::Message() << grid.x << 'x' << grid.y << 'x' << grid.z << ' '
                                          << share << ' ' << seed << (smooth ? " smooth" : ""));
          check(test::random_field(grid, share, seed), smooth);
        }
      }
    }
  }
}

TEST(PushPull, LeavesWhatIsKnownBitForBit) {
  for_fields([](const VectorField& before, bool smooth) {
    VectorField field = before;
    push_pull(field, smooth);
    ASSERT_EQ(field.vertices.size(), before.vertices.size());
    ASSERT_EQ(field.known.size(), before.known.size());
    EXPECT_EQ(field.geometry, before.geometry);
    for (std::size_t i = 0; i < field.vertices.size(); ++i) {
      if (before.known[i] == 0) continue;
      EXPECT_TRUE(test::same_bits(field.vertices[i], before.vertices[i]));
    }
    EXPECT_EQ(std::ranges::count(field.known, 0), 0);
  });
}

TEST(PushPull, NothingOfWhatIsNotKnownGoesIn) {
  for_fields([](VectorField field, bool smooth) {
    VectorField other = field;
    ddgi::Random random(9);
    for (std::size_t i = 0; i < other.vertices.size(); ++i) {
      if (other.known[i] == 0) other.vertices[i] = test::random_vertex(random);
    }
    push_pull(field, smooth);
    push_pull(other, smooth);
    EXPECT_EQ(field.vertices, other.vertices);
  });
}

TEST(PushPull, WhatIsTheSameEverywhereIsSoAfterwards) {
  for_fields([](VectorField field, bool smooth) {
    ddgi::Random random(4);
    const Vertex constant = test::random_vertex(random);
    for (std::size_t i = 0; i < field.vertices.size(); ++i) {
      if (field.known[i] != 0) field.vertices[i] = constant;
    }
    push_pull(field, smooth);
    const test::Numbers expected = test::numbers_of(constant);
    for (const Vertex& vertex : field.vertices) {
      const test::Numbers numbers = test::numbers_of(vertex);
      for (std::size_t n = 0; n < numbers.size(); ++n) {
        ASSERT_NEAR(numbers[n], expected[n], 1e-5 * std::abs(expected[n]));
      }
    }
  });
}

TEST(PushPull, StaysWithinTheRangeOfWhatIsKnown) {
  for_fields([](VectorField field, bool smooth) {
    test::Numbers least, most;
    least.fill(INFINITY), most.fill(-INFINITY);
    for (std::size_t i = 0; i < field.vertices.size(); ++i) {
      if (field.known[i] == 0) continue;
      const test::Numbers numbers = test::numbers_of(field.vertices[i]);
      for (std::size_t n = 0; n < numbers.size(); ++n) {
        least[n] = std::min(least[n], numbers[n]), most[n] = std::max(most[n], numbers[n]);
      }
    }
    push_pull(field, smooth);
    for (const Vertex& vertex : field.vertices) {
      const test::Numbers numbers = test::numbers_of(vertex);
      for (std::size_t n = 0; n < numbers.size(); ++n) {
        ASSERT_GE(numbers[n], least[n] - 1e-5F);
        ASSERT_LE(numbers[n], most[n] + 1e-5F);
      }
    }
  });
}

TEST(PushPull, WhereNothingIsKnownNothingHappens) {
  for (const Grid& grid : kGrids) {
    for (const bool smooth : {false, true}) {
      VectorField field = test::random_field(grid, 0.5F, 1);
      std::ranges::fill(field.known, std::uint8_t{0});
      const VectorField before = field;
      push_pull(field, smooth);
      EXPECT_EQ(field.vertices, before.vertices);
      EXPECT_EQ(field.known, before.known);
    }
  }
}

/// Between two ends of a row values go from one to the other, more smoothly with the filter.
TEST(PushPull, IsNearWhatIsNear) {
  constexpr std::uint32_t kLast = 31;
  float steepest[2] = {};
  for (const bool smooth : {false, true}) {
    VectorField field(VolumeGeometry{{kLast + 1, 1, 1}});
    for (Vectors& vectors : field.vertices[kLast]) vectors.red.x = 1;
    field.known[0] = field.known[kLast] = 1;
    push_pull(field, smooth);
    const auto value = [&](std::uint32_t x) { return field.vertices[x][0].red.x; };
    for (std::uint32_t x = 0; x < kLast; ++x) {
      EXPECT_LE(value(x), value(x + 1) + 1e-6F) << x;
      if (x > 0 && x + 1 < kLast)
        steepest[smooth ? 1 : 0] = std::max(steepest[smooth ? 1 : 0], value(x + 1) - value(x));
    }
    for (std::uint32_t x = 0; x <= kLast; ++x) EXPECT_NEAR(value(x) + value(kLast - x), 1, 1e-6);
    EXPECT_LT(value(kLast / 4), 0.35F);
  }
  EXPECT_LE(steepest[1], steepest[0]);
}

}  // namespace
}  // namespace gicodec::vectors
