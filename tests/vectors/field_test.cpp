// Looking irradiance up (Pacanowski et al. §3.2).
#include "fields.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gicodec::vectors {
namespace {

constexpr std::array kBoth{Interpolation::trilinear, Interpolation::tricubic};
constexpr Grid kGrid{5, 3, 4};

Vec3 place_of(const VectorField& field, std::uint32_t vertex) {
  const Position at = block_position(field.geometry, vertex);
  return {at[0], at[1], at[2]};
}

/// Anywhere in the grid and around it.
Vec3 any_place(const VectorField& field, ddgi::Random& random) {
  const Vec3 first = place_of(field, 0);
  const Vec3 last = place_of(field, static_cast<std::uint32_t>(field.vertices.size()) - 1);
  const auto one = [&](float lo, float hi) { return random.in(lo - 1, hi + 1); };
  return {one(first.x, last.x), one(first.y, last.y), one(first.z, last.z)};
}

void expect_within(Vec3 value, Vec3 expected, float error) {
  EXPECT_NEAR(value.x, expected.x, error);
  EXPECT_NEAR(value.y, expected.y, error);
  EXPECT_NEAR(value.z, expected.z, error);
}

TEST(VectorField, IsExactAtVerticesAlongTheAxes) {
  const VectorField field = test::random_field(kGrid, 1, 1);
  for (std::uint32_t vertex = 0; vertex < field.vertices.size(); ++vertex) {
    for (std::size_t h = 0; h < kHemispheres; ++h) {
      const Vec3 expected = max(field.vertices[vertex][h].along(axis_of(h)), {});
      EXPECT_EQ(field.irradiance(place_of(field, vertex), axis_of(h), Interpolation::trilinear),
                expected);
    }
  }
}

/// Of three hemispheres, by the signs of the normal, with the squares of its coordinates.
TEST(VectorField, WeighsHemispheresByTheNormal) {
  const VectorField field = test::random_field(kGrid, 1, 2);
  ddgi::Random random(3);
  for (int i = 0; i < 500; ++i) {
    const auto vertex = static_cast<std::uint32_t>(i) % 60;
    const Vec3 n = test::random_direction(random);
    const Vertex& v = field.vertices[vertex];
    const Vec3 expected = v[n.x >= 0 ? 0 : 1].along(n) * (n.x * n.x) +
                          v[n.y >= 0 ? 2 : 3].along(n) * (n.y * n.y) +
                          v[n.z >= 0 ? 4 : 5].along(n) * (n.z * n.z);
    expect_within(field.irradiance(place_of(field, vertex), n, Interpolation::trilinear),
                  max(expected, {}), 1e-5F);
  }
}

TEST(VectorField, IsConstantWhereVerticesAre) {
  VectorField field = test::random_field(kGrid, 1, 4);
  Vertex constant{};
  for (std::size_t h = 0; h < kHemispheres; ++h) {
    const Vec3 axis = axis_of(h);
    constant[h] = {axis * 0.25F, axis * 3, axis * 100};
  }
  for (Vertex& vertex : field.vertices) vertex = constant;
  ddgi::Random random(5);
  for (const Interpolation interpolation : kBoth) {
    for (int i = 0; i < 300; ++i) {
      const Vec3 place = any_place(field, random);
      for (std::size_t h = 0; h < kHemispheres; ++h) {
        const Vec3 value = field.irradiance(place, axis_of(h), interpolation);
        expect_within(value / 100, Vec3{0.25F, 3, 100} / 100, 1e-5F);
      }
    }
  }
}

/// Both interpolations have what is linear, as far from the edges as they reach.
TEST(VectorField, FollowsWhatIsLinear) {
  constexpr Grid kLarge{7, 6, 8};
  VectorField field = test::random_field(kLarge, 1, 6);
  const auto value = [](Vec3 p) { return 10 + p.x + 0.5F * p.y - 2 * p.z; };
  for (std::uint32_t i = 0; i < field.vertices.size(); ++i) {
    for (std::size_t h = 0; h < kHemispheres; ++h) {
      const Vec3 v = axis_of(h) * value(place_of(field, i));
      field.vertices[i][h] = {v, v * 0.5F, v * 2};
    }
  }
  ddgi::Random random(7);
  const VolumeGeometry& geometry = field.geometry;
  const Grid& grid = geometry.grid;
  for (const Interpolation interpolation : kBoth) {
    const float edge = interpolation == Interpolation::tricubic ? 1 : 0;
    for (int i = 0; i < 500; ++i) {
      const auto along = [&](std::size_t axis, std::uint32_t vertices) {
        const float last = static_cast<float>(vertices - 1) - edge;
        return geometry.origin[axis] + geometry.spacing[axis] * random.in(edge, last);
      };
      const Vec3 p{along(0, grid.x), along(1, grid.y), along(2, grid.z)};
      const float expected = std::max(value(p), 0.0F);
      if (value(p) < 0.1F) continue;
      expect_within(field.irradiance(p, axis_of(static_cast<std::size_t>(i) % 6), interpolation),
                    Vec3{1, 0.5F, 2} * expected, 1e-4F);
    }
  }
}

TEST(VectorField, OutsideIsAsItsNearestPlace) {
  const VectorField field = test::random_field(kGrid, 0.7F, 8);
  const Vec3 first = place_of(field, 0);
  const Vec3 last = place_of(field, static_cast<std::uint32_t>(field.vertices.size()) - 1);
  ddgi::Random random(9);
  for (const Interpolation interpolation : kBoth) {
    for (int i = 0; i < 500; ++i) {
      const Vec3 place = any_place(field, random), n = test::random_direction(random);
      const Vec3 inside = max(first, min(last, place));
      EXPECT_EQ(field.irradiance(place, n, interpolation),
                field.irradiance(inside, n, interpolation));
    }
    EXPECT_EQ(field.irradiance({1e30F, -1e30F, INFINITY}, {0, 1, 0}, interpolation),
              field.irradiance({last.x, first.y, last.z}, {0, 1, 0}, interpolation));
  }
}

TEST(VectorField, WhatIsNotKnownHasNoWeight) {
  VectorField field = test::random_field(kGrid, 0, 10);  // One is known, of which there are 60.
  ASSERT_EQ(std::ranges::count(field.known, 1), 1);
  const auto vertex =
      static_cast<std::size_t>(std::ranges::find(field.known, 1) - field.known.begin());
  ddgi::Random random(11);
  for (const Interpolation interpolation : kBoth) {
    std::size_t lit = 0;
    for (int i = 0; i < 500; ++i) {
      const Vec3 place = any_place(field, random);
      const std::size_t h = static_cast<std::size_t>(i) % kHemispheres;
      const Vec3 value = field.irradiance(place, axis_of(h), interpolation);
      if (value == Vec3{}) continue;
      ++lit;
      expect_within(value, max(field.vertices[vertex][h].along(axis_of(h)), {}), 1e-5F);
    }
    EXPECT_GT(lit, 0U);
    EXPECT_LT(lit, 500U);
  }
  std::ranges::fill(field.known, std::uint8_t{0});
  for (const Interpolation interpolation : kBoth) {
    EXPECT_EQ(field.irradiance(any_place(field, random), {0, 0, -1}, interpolation), Vec3{});
  }
}

TEST(VectorField, WhereverItIsAskedItAnswers) {
  for (const Grid grid : {Grid{1, 1, 1}, Grid{2, 1, 3}, kGrid}) {
    const VectorField field = test::random_field(grid, 1, 12);
    for (const Interpolation interpolation : kBoth) {
      for (const Vec3 place : {Vec3{NAN, 0, 0}, Vec3{NAN, NAN, NAN}, Vec3{0, INFINITY, -INFINITY},
                               Vec3{3e38F, -3e38F, 0}}) {
        const Vec3 value = field.irradiance(place, {0, 1, 0}, interpolation);
        EXPECT_TRUE(std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z));
        EXPECT_GE(std::min({value.x, value.y, value.z}), 0);
      }
    }
  }
}

/// Where all weights are next to none: none, or what is known.
TEST(VectorField, TheLeastWeightsAreNoneOrCount) {
  VectorField field(VolumeGeometry{{4, 4, 4}});
  for (const std::uint32_t vertex : {21U, 63U}) {  // (1, 1, 1) and (3, 3, 3)
    field = VectorField(field.geometry);
    for (std::size_t h = 0; h < kHemispheres; ++h) {
      field.vertices[vertex][h] = DirectedColor{axis_of(h), {1, 2, 3}}.vectors();
    }
    field.known[vertex] = 1;
    for (const Interpolation interpolation : kBoth) {
      for (float tiny = 1; tiny > 0; tiny /= 2) {
        for (const Vec3 place : {Vec3{tiny, tiny, tiny}, Vec3{tiny, tiny, 1}, Vec3{tiny, 1, 1},
                                 Vec3{1 + tiny, 1 + tiny, 1 + tiny}, Vec3{1 + tiny, 1 + tiny, 2}}) {
          const Vec3 value = field.irradiance(place, {0, 1, 0}, interpolation);
          if (value != Vec3{}) expect_within(value, {1, 2, 3}, 1e-4F);
        }
      }
    }
  }
}

}  // namespace
}  // namespace gicodec::vectors
