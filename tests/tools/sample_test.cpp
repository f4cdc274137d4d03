#include "dump/sample.h"

#include <gtest/gtest.h>

#include <array>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>

namespace gicodec::tools {
namespace {

constexpr Component kTenBits{"R", 20, 10, ComponentType::unorm};
constexpr Component kAlpha{"A", 30, 2, ComponentType::unorm};
constexpr Component kByte{"R", 0, 8, ComponentType::unorm};
constexpr Component kSixteenBits{"R", 0, 16, ComponentType::unorm};
constexpr Component kHalf{"R", 0, 16, ComponentType::sfloat};
constexpr Component kFloat{"R", 0, 32, ComponentType::sfloat};
constexpr Component kUnsigned11{"R", 0, 11, ComponentType::ufloat};
constexpr Component kUnsigned10{"B", 22, 10, ComponentType::ufloat};

double value_of_half(std::uint32_t bits) { return std::bit_cast<float>(widen_half(bits)); }

void expect_nearest_halves(const Component& component) {
  for (std::uint32_t code = 0; code <= max_code(component); ++code) {
    const double exact = static_cast<double>(code) / max_code(component);
    const std::uint32_t half = to_sample(SampleType::half, component, code);
    const double error = std::abs(value_of_half(half) - exact);
    EXPECT_LE(error, std::abs(value_of_half(half + 1) - exact)) << code;
    EXPECT_LE(error, std::abs(value_of_half(half == 0 ? 0 : half - 1) - exact)) << code;
    EXPECT_EQ(to_code(SampleType::half, component, half), code);
  }
}

// Every half either is the sample of exactly one code, or of none.
void expect_only_codes(const Component& component) {
  std::map<std::uint32_t, std::uint32_t> halves;
  for (std::uint32_t half = 0; half < 65536; ++half) {
    const auto code = to_code(SampleType::half, component, half);
    if (!code) continue;
    EXPECT_LE(*code, max_code(component));
    EXPECT_EQ(to_sample(SampleType::half, component, *code), half);
    EXPECT_TRUE(halves.emplace(*code, half).second) << *code;
  }
  EXPECT_EQ(halves.size(), std::size_t{max_code(component)} + 1);
}

TEST(Sample, CodesAreTheNearestHalves) {
  expect_nearest_halves(kTenBits);
  expect_nearest_halves(kAlpha);
  expect_nearest_halves(kByte);
}

TEST(Sample, OtherHalvesAreNoCode) {
  expect_only_codes(kTenBits);
  expect_only_codes(kAlpha);
  expect_only_codes(kByte);
  expect_only_codes(kUnsigned11);
  expect_only_codes(kUnsigned10);
}

TEST(Sample, CodesAsFloats) {
  for (const Component& component : {kTenBits, kAlpha, kByte, kSixteenBits}) {
    for (std::uint32_t code = 0; code <= max_code(component); ++code) {
      const std::uint32_t bits = to_sample(SampleType::float32, component, code);
      EXPECT_EQ(std::bit_cast<float>(bits),
                static_cast<float>(code) / static_cast<float>(max_code(component)));
      EXPECT_EQ(to_code(SampleType::float32, component, bits), code);
      EXPECT_FALSE(to_code(SampleType::float32, component, bits + 1)) << code;
      EXPECT_FALSE(to_code(SampleType::float32, component, bits - 1)) << code;
    }
  }
}

TEST(Sample, CodesAsIntegers) {
  EXPECT_EQ(to_code(SampleType::uint32, kTenBits, 1023), 1023U);
  EXPECT_FALSE(to_code(SampleType::uint32, kTenBits, 1024));
  EXPECT_FALSE(to_code(SampleType::uint32, kAlpha, 4));
  EXPECT_EQ(to_code(SampleType::uint32, kFloat, UINT32_MAX), UINT32_MAX);
}

TEST(Sample, SpecialValuesAreNoCode) {
  for (const std::uint32_t half : {0x8000U, 0x7C00U, 0xFC00U, 0x7E00U, 0x7C01U, 0x3C01U, 0xBC00U}) {
    EXPECT_FALSE(to_code(SampleType::half, kTenBits, half)) << half;
    EXPECT_FALSE(to_code(SampleType::float32, kTenBits, widen_half(half))) << half;
  }
}

TEST(Sample, HalvesKeepTheirBits) {
  for (std::uint32_t half = 0; half < 65536; ++half) {
    EXPECT_EQ(to_code(SampleType::half, kHalf, half), half);
    EXPECT_EQ(to_sample(SampleType::half, kHalf, half), half);
    const std::uint32_t wide = to_sample(SampleType::float32, kHalf, half);
    EXPECT_EQ(to_code(SampleType::float32, kHalf, wide), half);
    EXPECT_FALSE(to_code(SampleType::float32, kHalf, wide ^ 1U)) << half;
  }
}

TEST(Sample, WideningAgreesWithArithmetic) {
  for (std::uint32_t half = 0; half < 65536; ++half) {
    const std::uint32_t exponent = half >> 10 & 31U;
    if (exponent == 31) continue;
    const double mantissa = half & 1023U;
    const double magnitude = exponent == 0
                                 ? std::ldexp(mantissa, -24)
                                 : std::ldexp(1024 + mantissa, static_cast<int>(exponent) - 25);
    const double value = std::bit_cast<float>(widen_half(half));
    EXPECT_EQ(std::abs(value), magnitude) << half;
    EXPECT_EQ(std::signbit(value), half >= 0x8000U) << half;
  }
}

TEST(Sample, UnsignedFloats) {
  for (const Component& component : {kUnsigned11, kUnsigned10}) {
    for (std::uint32_t code = 0; code <= max_code(component); ++code) {
      for (const SampleType type : {SampleType::half, SampleType::float32, SampleType::uint32}) {
        EXPECT_EQ(to_code(type, component, to_sample(type, component, code)), code);
      }
    }
  }
}

// Each value of a mantissa and an exponent, beside the largest one that needs that exponent.
TEST(Sample, SharedExponents) {
  for (const SampleType type : {SampleType::half, SampleType::float32}) {
    const std::array<SampleType, 3> types = {type, type, type};
    for (std::uint32_t exponent = 0; exponent < 32; ++exponent) {
      for (std::uint32_t mantissa = 0; mantissa < 512; ++mantissa) {
        const std::array<std::uint32_t, 4> codes = {mantissa, 511, 511 - mantissa, exponent};
        std::array<std::uint32_t, 3> samples{};
        for (std::size_t i = 0; i < 3; ++i) {
          samples[i] = shared_exponent_sample(type, codes[i], exponent);
          const std::uint32_t wide = type == SampleType::half ? widen_half(samples[i]) : samples[i];
          EXPECT_EQ(std::bit_cast<float>(wide),
                    std::ldexp(static_cast<float>(codes[i]), static_cast<int>(exponent) - 24));
        }
        EXPECT_EQ(shared_exponent_codes(types, samples), codes);
      }
    }
  }
}

TEST(Sample, ValuesThatShareNoExponent) {
  constexpr std::array<SampleType, 3> kFloats = {SampleType::float32, SampleType::float32,
                                                 SampleType::float32};
  const auto codes = [&](float r, float g, float b) {
    return shared_exponent_codes(kFloats,
                                 {std::bit_cast<std::uint32_t>(r), std::bit_cast<std::uint32_t>(g),
                                  std::bit_cast<std::uint32_t>(b)});
  };
  EXPECT_EQ(codes(0, 0, 0), (std::array<std::uint32_t, 4>{}));
  EXPECT_TRUE(codes(65408, 128, 0));
  for (const float bad : {-0.0F, -1.0F, 65409.0F, INFINITY, -INFINITY, NAN, 1 / 3.0F, 0x1p-25F}) {
    EXPECT_FALSE(codes(bad, 0, 0)) << bad;
    EXPECT_FALSE(codes(0, 0, bad)) << bad;
  }
  // Exact alone, not beside the other.
  EXPECT_TRUE(codes(1, 0, 0));
  EXPECT_FALSE(codes(1, 65408, 0));
  EXPECT_TRUE(codes(0, 0x1p-24F, 0));
  EXPECT_FALSE(codes(0, 0x1p-24F, 1));
}

TEST(Sample, ChannelsHoldEveryCodeOrAreRefused) {
  const auto types = [](ComponentType kind, std::uint8_t bits) {
    Record record;
    record.bytes = 4;
    record.count = 1;
    record.components[0] = {"R", 0, bits, kind};
    std::string text;
    for (const auto type : {SampleType::uint32, SampleType::half, SampleType::float32}) {
      if (can_hold(type, record.components[0], record)) text += to_string(type).substr(0, 1);
    }
    return text;
  };
  EXPECT_EQ(types(ComponentType::unorm, 8), "UHF");
  EXPECT_EQ(types(ComponentType::unorm, 10), "UHF");
  EXPECT_EQ(types(ComponentType::unorm, 11), "UF");
  EXPECT_EQ(types(ComponentType::unorm, 16), "UF");
  EXPECT_EQ(types(ComponentType::unorm, 17), "U");
  EXPECT_EQ(types(ComponentType::unorm, 32), "U");
  EXPECT_EQ(types(ComponentType::sfloat, 16), "UHF");
  EXPECT_EQ(types(ComponentType::sfloat, 32), "UF");
  EXPECT_EQ(types(ComponentType::ufloat, 11), "UHF");
  for (const auto kind : {ComponentType::snorm, ComponentType::uint, ComponentType::exponent,
                          ComponentType::opaque}) {
    EXPECT_EQ(types(kind, 8), "U");
  }
}

TEST(Sample, ComponentsOfEveryFormat) {
  for (const FormatInfo& format : formats()) {
    for (std::size_t i = 0; i < format.record.count; ++i) {
      std::byte texel[16] = {};
      store_component(texel, format.record.bytes, format.record.components[i],
                      max_code(format.record.components[i]));
      for (std::size_t j = 0; j < format.record.count; ++j) {
        EXPECT_EQ(load_component(texel, format.record.bytes, format.record.components[j]),
                  i == j ? max_code(format.record.components[j]) : 0U);
      }
    }
  }
}

}  // namespace
}  // namespace gicodec::tools
