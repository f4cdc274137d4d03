// The paper's transforms and the byte planes: each inverse undoes its forward, bit by bit.
#include "distinct_formats.h"
#include "inverses.h"
#include "shapes.h"
#include "support.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstring>

namespace gicodec {
namespace {

using namespace test;

constexpr Format kPackings[] = {Format::A2R10G10B10_UNORM_PACK32, Format::A2B10G10R10_UNORM_PACK32};
constexpr SampleAlignment kAlignments[] = {SampleAlignment::high, SampleAlignment::low};

std::uint32_t pack(Format format, std::uint32_t r, std::uint32_t g, std::uint32_t b,
                   std::uint32_t a) {
  return format == Format::A2R10G10B10_UNORM_PACK32 ? a << 30 | r << 20 | g << 10 | b
                                                    : a << 30 | b << 20 | g << 10 | r;
}

Exact texels_of(std::span<const std::uint32_t> words) { return Exact(std::as_bytes(words)); }

using Samples16 = Samples<std::uint16_t>;

TEST(Yuv444p16, EveryCodeOfEveryChannel) {
  for (const auto format : kPackings) {
    for (const auto alignment : kAlignments) {
      const unsigned shift = alignment == SampleAlignment::high ? 6 : 0;
      std::vector<std::uint32_t> words;
      for (std::uint32_t code = 0; code < 1024; ++code) {
        words.push_back(pack(format, code, 1023 - code, (code * 7) & 1023, 0));
      }
      const Exact texels = texels_of(words);
      Samples16 samples(words.size());
      to_yuv444p16(best_isa(), format, alignment, texels.span(), samples.planes());
      for (std::uint32_t code = 0; code < 1024; ++code) {
        ASSERT_EQ(samples.y[code], code << shift);
        ASSERT_EQ(samples.u[code], (1023 - code) << shift);
        ASSERT_EQ(samples.v[code], ((code * 7) & 1023) << shift);
      }
      Exact back(texels.span().size());
      ASSERT_TRUE(from_yuv444p16(best_isa(), format, alignment, std::as_const(samples).planes(),
                                 back.span()));
      EXPECT_TRUE(std::ranges::equal(back.span(), texels.span()));
    }
  }
}

TEST(Yuv444p16, ABitOutsideTheTenIsRefused) {
  for (const auto format : kPackings) {
    for (const auto alignment : kAlignments) {
      for (unsigned bit = 0; bit < 16; ++bit) {
        const bool used = alignment == SampleAlignment::high ? bit >= 6 : bit < 10;
        for (int plane = 0; plane < 3; ++plane) {
          Samples16 samples(5, 0);
          (plane == 0   ? samples.y
           : plane == 1 ? samples.u
                        : samples.v)[4] = static_cast<std::uint16_t>(1U << bit);
          Exact back(20);
          EXPECT_EQ(from_yuv444p16(best_isa(), format, alignment, std::as_const(samples).planes(),
                                   back.span()),
                    used)
              << bit;
        }
      }
    }
  }
}

RC_GTEST_PROP(Yuv444p16, AnyTexelsAndAlpha, (const std::vector<std::uint32_t>& words)) {
  for (const auto format : kPackings) {
    for (const auto alignment : kAlignments) {
      RC_ASSERT(broken_yuv444p16(format, alignment, words) == "");
    }
  }
}

TEST(Alpha, ConstantIsFoundAndVaryingIsNot) {
  EXPECT_EQ(constant_alpha({}), std::uint8_t{0});
  Random random(1);
  for (std::uint32_t alpha = 0; alpha < 4; ++alpha) {
    std::vector<std::uint32_t> words(9);
    for (auto& word : words) word = (static_cast<std::uint32_t>(random()) >> 2) | alpha << 30;
    const auto found = constant_alpha(std::as_bytes(std::span(words)));
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(*found, alpha);
    auto bare = words;
    for (auto& word : bare) word &= 0x3FFFFFFF;
    add_alpha(*found, std::as_writable_bytes(std::span(bare)));
    EXPECT_EQ(bare, words);
    for (auto& word : words) {
      word ^= 1U << 31;
      EXPECT_FALSE(constant_alpha(std::as_bytes(std::span(words))).has_value());
      word ^= 1U << 31;
    }
  }
}

TEST(Alpha, FourToAByteFirstTexelLowest) {
  const std::vector<std::uint32_t> words{1U << 30, 2U << 30, 3U << 30, 0, 3U << 30};
  Exact packed(2);
  pack_alpha(std::as_bytes(std::span(words)), packed.span());
  EXPECT_EQ(packed.span()[0], std::byte{0b00111001});
  EXPECT_EQ(packed.span()[1], std::byte{0b00000011});
}

using Samples8 = Samples<std::uint8_t>;

TEST(Yuv444p8, ThreeTexelsBecomeYuvyUvyuVyuv) {
  const std::uint8_t row[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  ASSERT_EQ(yuv444p8_width(sizeof row), 4U);
  Samples8 samples(4);
  to_yuv444p8(best_isa(), std::as_bytes(std::span(row)), samples.planes());
  EXPECT_EQ(samples.y, (std::vector<std::uint8_t>{1, 4, 7, 10}));
  EXPECT_EQ(samples.u, (std::vector<std::uint8_t>{2, 5, 8, 11}));
  EXPECT_EQ(samples.v, (std::vector<std::uint8_t>{3, 6, 9, 12}));
}

RC_GTEST_PROP(Yuv444p8, AnyRow, (const std::vector<std::uint8_t>& row)) {
  RC_ASSERT(broken_yuv444p8(std::as_bytes(std::span(row))) == "");
}

TEST(Yuv444p8, EveryWidthAndTexelSize) {
  Random random(8);
  for (const std::size_t texel : {1U, 2U, 4U, 8U, 16U}) {
    for (std::size_t width = 0; width < 40; ++width) {
      const Exact row(noise(random, texel * width));
      const auto size = yuv444p8_width(row.span().size());
      if (texel == 4) {
        ASSERT_EQ(size, (4 * width + 2) / 3);
      }
      Samples8 samples(size);
      to_yuv444p8(best_isa(), row.span(), samples.planes());
      Exact back(row.span().size());
      ASSERT_TRUE(from_yuv444p8(best_isa(), std::as_const(samples).planes(), back.span()));
      ASSERT_TRUE(std::ranges::equal(back.span(), row.span()));

      const std::size_t rest = row.span().size() % 3;
      if (rest == 0) continue;
      ASSERT_EQ(samples.v.back(), 0);
      samples.v.back() = 1;
      EXPECT_FALSE(from_yuv444p8(best_isa(), std::as_const(samples).planes(), back.span()));
      samples.v.back() = 0;
      if (rest == 2) continue;
      ASSERT_EQ(samples.u.back(), 0);
      samples.u.back() = 0x80;
      EXPECT_FALSE(from_yuv444p8(best_isa(), std::as_const(samples).planes(), back.span()));
    }
  }
}

RC_GTEST_PROP(BytePlanes, AnyRecordWithAndWithoutReference, (std::uint64_t seed)) {
  Random random(seed);
  const Record record = any_record(random);
  // Around the transform's internal step of 512 records as well.
  const std::size_t count = chance(random, 3) ? pick(random, 505, 1540) : pick(random, 0, 70);
  const Exact records(noise(random, count * record.bytes));
  const Exact reference(noise(random, count * record.bytes));
  for (const bool difference : {false, true}) {
    const auto ref = difference ? reference.span() : std::span<const std::byte>{};
    RC_ASSERT(broken_byte_planes(record, records.span(), ref) == "");
  }
}

TEST(BytePlanes, NoTexelsNeedNoMemory) {
  for (const auto& info : test::distinct_formats())
    EXPECT_EQ(broken_byte_planes(info.record, {}, {}), "");
}

TEST(BytePlanes, NoDifferenceIsAllZero) {
  Random random(9);
  for (const auto& info : test::distinct_formats()) {
    const auto texels = noise(random, 33U * info.record.bytes);
    Bytes planes(texels.size(), std::byte{1});
    to_byte_planes(best_isa(), info.record, texels, texels, planes);
    EXPECT_TRUE(std::ranges::all_of(planes, [](auto b) { return b == std::byte{0}; })) << info.name;
  }
}

/// All pairs of value and reference in a component `shift` bits up; small differences of either
/// sign must leave the high bits zero.
void check_all_pairs(Format format, unsigned shift, unsigned bits) {
  const std::uint32_t codes = 1U << bits;
  std::vector<std::uint32_t> values(codes), references(codes), back(codes);
  Bytes planes(4 * std::size_t{codes});
  for (std::uint32_t i = 0; i < codes; ++i) values[i] = i << shift;
  for (std::uint32_t reference = 0; reference < codes; ++reference) {
    std::ranges::fill(references, reference << shift);
    const auto ref = std::as_bytes(std::span(references));
    to_byte_planes(best_isa(), format, std::as_bytes(std::span(values)), ref, planes);
    from_byte_planes(best_isa(), format, planes, ref, std::as_writable_bytes(std::span(back)));
    ASSERT_EQ(back, values) << reference;
    const std::uint32_t above = (reference + 1) % codes, below = (reference + codes - 1) % codes;
    for (std::size_t plane = 0; plane < 4; ++plane) {
      const auto at = [&](std::uint32_t i) {
        return std::to_integer<int>(planes[plane * codes + i]);
      };
      ASSERT_EQ(at(reference), 0);
      ASSERT_TRUE(at(below) == 0 || at(below) == 1);
      ASSERT_TRUE(at(above) == 0 || at(above) == 2);
    }
  }
}

TEST(BytePlanes, AllPairsOfTenBitCodes) {
  check_all_pairs(Format::A2R10G10B10_UNORM_PACK32, 20, 10);
  check_all_pairs(Format::A2B10G10R10_UNORM_PACK32, 10, 10);
}
TEST(BytePlanes, AllPairsOfNineAndEightBitCodes) {
  check_all_pairs(Format::E5B9G9R9_UFLOAT_PACK32, 9, 9);
  check_all_pairs(Format::R8G8B8A8_UNORM, 16, 8);
}

}  // namespace
}  // namespace gicodec
