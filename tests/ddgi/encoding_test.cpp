// Octahedral map, guard band in bilinear fetches, gamma 5, half moments.
#include "ddgi/noise.h"
#include "ddgi/octahedral.h"
#include "ddgi/rays.h"
#include "ddgi/volume.h"

#include <gtest/gtest.h>

namespace gicodec::ddgi {
namespace {

TEST(Octahedral, MapAndUnmapGiveTheDirectionBack) {
  for (const Vec3 d : fibonacci_directions(20000)) {
    EXPECT_GT(dot(octahedral_decode(octahedral_encode(d)), d), 1 - 1e-6F);
  }
  for (const Vec3 d : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{-1, 0, 0}, Vec3{0, -1, 0},
                       Vec3{0, 0, -1}}) {
    EXPECT_GT(dot(octahedral_decode(octahedral_encode(d)), d), 1 - 1e-6F);
  }
}

TEST(Octahedral, FetchAtATexelsDirectionReadsThatTexel) {
  for (const std::uint32_t core : {6U, 8U, 16U}) {
    for (std::uint32_t y = 0; y < core; ++y) {
      for (std::uint32_t x = 0; x < core; ++x) {
        const Fetch f = bilinear_fetch(texel_direction(x, y, core), core);
        EXPECT_NEAR(static_cast<float>(f.x) + f.fx, static_cast<float>(x + 1), 1e-4F);
        EXPECT_NEAR(static_cast<float>(f.y) + f.fy, static_cast<float>(y + 1), 1e-4F);
      }
    }
  }
}

TEST(Octahedral, FetchesStayInsideTheBlock) {
  for (const Vec3 d : fibonacci_directions(50000)) {
    const Fetch f = bilinear_fetch(d, 8);
    EXPECT_LE(f.x + 1, 9U);
    EXPECT_LE(f.y + 1, 9U);
    EXPECT_GE(f.fx, 0);
    EXPECT_LE(f.fx, 1);
  }
}

// Whatever the core texels hold, directions just beside each other must fetch nearly the same, also
// where the square's edges meet: on the meridians x = 0 and y = 0 of the lower half. A guard band
// that does not follow the rule makes the light jump there.
TEST(Octahedral, GuardBandHasNoSeams) {
  constexpr std::uint32_t core = 8, side = core + 2;
  Random random(4);
  std::vector<std::uint32_t> block(std::size_t{side} * side);
  for (std::uint32_t& texel : block) texel = static_cast<std::uint32_t>(random.in(0, 1000));
  const auto fetched = [&](Vec3 d) {
    const Fetch at = bilinear_fetch(normalize(d), core);
    const auto value = [&](std::uint32_t dx, std::uint32_t dy) {
      return static_cast<float>(block[(at.y + dy) * side + at.x + dx]);
    };
    return mix(mix(value(0, 0), value(1, 0), at.fx), mix(value(0, 1), value(1, 1), at.fx), at.fy);
  };
  const auto largest_jump = [&] {
    float jump = 0;
    for (int i = -100; i <= 100; ++i) {
      const float angle = static_cast<float>(i) / 100 * kPi / 2, a = std::sin(angle),
                  z = -std::cos(angle);
      constexpr float step = 1e-5F;
      jump = std::max(jump, std::abs(fetched({step, a, z}) - fetched({-step, a, z})));
      jump = std::max(jump, std::abs(fetched({a, step, z}) - fetched({a, -step, z})));
    }
    return jump;
  };
  EXPECT_GT(largest_jump(), 50);  // the border holds noise
  fill_guard_band(std::as_writable_bytes(std::span(block)), side, 4);
  EXPECT_LT(largest_jump(), 0.5F);
}

TEST(Gamma5, EveryCodeSurvives) {
  for (std::uint32_t code = 0; code < 1024; ++code) {
    EXPECT_EQ(encode_gamma5(decode_gamma5(code)), code);
    EXPECT_EQ(encode_gamma5(decode_gamma5(code), 1023 - code), code);  // a wrong guess
    EXPECT_EQ(encode_gamma5(decode_gamma5(code), code), code);
  }
  EXPECT_EQ(encode_gamma5(0), 0U);
  EXPECT_EQ(encode_gamma5(7.5F), 1023U);
  EXPECT_EQ(encode_gamma5(7.5F, 1023), 1023U);
}

TEST(Gamma5, NeverFalls) {
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const float a = random.next(), b = a + random.next() * 0.01F;
    const auto guess = static_cast<std::uint32_t>(random.in(0, 1023.9F));
    EXPECT_LE(encode_gamma5(a, guess), encode_gamma5(b, guess));
    EXPECT_NEAR(fifth_root(a), std::pow(static_cast<double>(a), 0.2), 1e-6);
  }
}

TEST(Rays, CoverTheSphereEvenly) {
  for (const std::uint32_t count : {1U, 64U, 256U, 1000U}) {
    const auto directions = fibonacci_directions(count);
    ASSERT_EQ(directions.size(), count);
    Vec3 sum;
    for (const Vec3 d : directions) {
      EXPECT_NEAR(length(d), 1, 1e-5F);
      sum += d;
    }
    if (count >= 64) {
      EXPECT_LT(length(sum) / static_cast<float>(count), 0.02F);
    }
  }
}

TEST(Rays, RotationsAreRotations) {
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Affine m = random_rotation(7, i);
    EXPECT_NEAR(m.determinant(), 1, 1e-5F);
    EXPECT_NEAR(dot(m.x, m.y), 0, 1e-5F);
    EXPECT_EQ(m, random_rotation(7, i));
    EXPECT_FALSE(m == random_rotation(8, i));
  }
}

}  // namespace
}  // namespace gicodec::ddgi
