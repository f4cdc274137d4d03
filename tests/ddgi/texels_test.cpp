// Texels of every format: codes survive, values become the nearest code, and what is stored is what
// dumps and clients read.
#include "ddgi/texels.h"
#include "ddgi/noise.h"
#include "dump/sample.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace gicodec::ddgi {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(Ufloat, EveryCodeSurvives) {
  for (const unsigned bits : {10U, 11U}) {
    const std::uint32_t finite = 31U << (bits - 5);
    for (std::uint32_t code = 0; code < finite; ++code) {
      ASSERT_EQ(to_ufloat(from_ufloat(code, bits), bits), code) << bits;
      // The value is the one that dumps show.
      const Component component("R", 0, static_cast<std::uint8_t>(bits), ComponentType::ufloat);
      ASSERT_EQ(std::bit_cast<float>(tools::to_sample(tools::SampleType::float32, component, code)),
                from_ufloat(code, bits));
    }
    EXPECT_EQ(to_ufloat(-1, bits), 0U);
    EXPECT_EQ(to_ufloat(std::numeric_limits<float>::quiet_NaN(), bits), 0U);
    EXPECT_EQ(to_ufloat(1e30F, bits), finite - 1);
    EXPECT_EQ(to_ufloat(kInfinity, bits), finite - 1);
  }
}

TEST(Ufloat, IsTheNearestCodeTiesToEven) {
  for (const unsigned bits : {10U, 11U}) {
    for (std::uint32_t code = 0; code + 1 < 31U << (bits - 5); ++code) {
      const float low = from_ufloat(code, bits), high = from_ufloat(code + 1, bits);
      const float middle = (low + high) / 2;  // exact: a float has bits to spare
      EXPECT_EQ(to_ufloat(middle, bits), code + (code & 1)) << code;
      EXPECT_EQ(to_ufloat(std::nextafter(middle, 0.0F), bits), code) << code;
      EXPECT_EQ(to_ufloat(std::nextafter(middle, kInfinity), bits), code + 1) << code;
    }
  }
}

TEST(SharedExponent, ErrorIsAtMostHalfAUnitOfTheLargestChannel) {
  Random random(5);
  for (int i = 0; i < 20000; ++i) {
    const float scale = std::exp2(random.in(-18, 15));
    const Vec3 c{random.next() * scale, random.next() * scale, random.next() * scale};
    const std::uint32_t texel = to_shared_exponent(c);
    const Vec3 back = from_shared_exponent(texel);
    const float half_unit = std::ldexp(0.5F, static_cast<int>(texel >> 27) - 24);
    EXPECT_LE(std::abs(back.x - c.x), half_unit);
    EXPECT_LE(std::abs(back.y - c.y), half_unit);
    EXPECT_LE(std::abs(back.z - c.z), half_unit);
    // The exponent is the least that holds all channels.
    const std::uint32_t most = std::max({texel & 511, texel >> 9 & 511, texel >> 18 & 511});
    EXPECT_TRUE(most >= 256 || texel >> 27 == 0) << texel;
    EXPECT_EQ(to_shared_exponent(back), texel);
  }
  EXPECT_EQ(to_shared_exponent({}), 0U);
  EXPECT_EQ(to_shared_exponent({-1, 0, -5}), 0U);
  EXPECT_EQ(from_shared_exponent(to_shared_exponent({1e9F, 0, 0})), (Vec3{65408, 0, 0}));
}

TEST(Half, StaysFinite) {
  EXPECT_EQ(from_half(to_half(1e9F)), 65504);
  EXPECT_EQ(from_half(to_half(-1e9F)), -65504);
  EXPECT_EQ(from_half(to_half(0.25F)), 0.25F);
}

TEST(FifthRoot, OfAnySize) {
  for (const float v : {0.0F, 1e-10F, 0.3F, 1.0F, 1.5F, 31.0F, 33.0F, 5000.0F, 1e20F}) {
    const double expected = std::pow(static_cast<double>(v), 0.2);
    EXPECT_NEAR(fifth_root(v), expected, 4e-6 * expected) << v;
  }
  EXPECT_TRUE(std::isfinite(fifth_root(kInfinity)));
}

TEST(ColorTexels, WhatIsStoredIsLoadedAgain) {
  Random random(6);
  for (const Format format : color_formats()) {
    for (const Encoding encoding : {Encoding::gamma5, Encoding::linear}) {
      const ColorTexels texels(format, encoding);
      const bool unorm = texels.unit() > 1;
      EXPECT_EQ(usual_encoding(format), unorm ? Encoding::gamma5 : Encoding::linear);
      for (int i = 0; i < 500; ++i) {
        std::array<std::byte, 16> texel{}, again{};
        const Vec3 light{random.next(), random.next(), random.next()};
        const Vec3 encoded = texels.encode(light);
        texels.store(texel.data(), encoded);
        const Vec3 stored = texels.load(texel.data());
        // Formats of the fewest bits: 8 of unorm, 5 of a mantissa.
        EXPECT_NEAR(stored.x / texels.unit(), encoded.x, 1 / 64.0F);
        EXPECT_NEAR(stored.z / texels.unit(), encoded.z, 1 / 64.0F);
        const float unit = texels.unit();
        texels.store(again.data(), {stored.x / unit, stored.y / unit, stored.z / unit});
        EXPECT_EQ(texel, again) << names_of(std::array{format});
        // Where nothing is mixed, a guess changes nothing.
        texels.store(again.data(), texels.encode(light, stored));
        const Vec3 near = texels.load(again.data());
        texels.store(again.data(), texels.encode(light, {}));
        EXPECT_EQ(texels.load(again.data()), near);
        EXPECT_NEAR(near.y, stored.y, unorm ? 1 : 0);
      }
    }
  }
}

TEST(ColorTexels, AlphaIsZeroOfUnormAndOneOfFloats) {
  const auto alpha = [](Format format) {
    std::array<std::byte, 16> texel{};
    ColorTexels(format, Encoding::linear).store(texel.data(), {0.5F, 0.5F, 0.5F});
    const Record record(format);
    return tools::load_component(texel.data(), record.bytes, record.components[3]);
  };
  EXPECT_EQ(alpha(Format::A2R10G10B10_UNORM_PACK32), 0U);
  EXPECT_EQ(alpha(Format::R8G8B8A8_UNORM), 0U);
  EXPECT_EQ(alpha(Format::R16G16B16A16_SFLOAT), 0x3C00U);
  EXPECT_EQ(alpha(Format::R32G32B32A32_SFLOAT), 0x3F800000U);
}

TEST(Moments, AreKeptInBothFormats) {
  std::array<std::byte, 8> texel{};
  for (const Format format : visibility_formats()) {
    store_moments(format, texel.data(), {1.5F, 3.0F});
    EXPECT_EQ(load_moments(format, texel.data()).x, 1.5F);
    EXPECT_EQ(load_moments(format, texel.data()).y, 3.0F);
  }
  store_moments(Format::R32G32_SFLOAT, texel.data(), {0.1F, 0.2F});
  EXPECT_EQ(load_moments(Format::R32G32_SFLOAT, texel.data()).x, 0.1F);
}

}  // namespace
}  // namespace gicodec::ddgi
