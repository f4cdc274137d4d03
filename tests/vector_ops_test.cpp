// What every operation of the vector wrappers means, lane by lane, on every instruction set.
#include "vector_ops.h"

#include "support.h"

#include <gtest/gtest.h>

#include <cstring>

namespace gicodec::test {
namespace {

using Lane16 = std::uint16_t;
using Lane32 = std::uint32_t;

int sign(Lane16 a) { return static_cast<std::int16_t>(a); }
Lane16 low(std::int64_t a) { return static_cast<Lane16>(a); }

/// Values at the ends of ranges more often than others.
Lane16 word(Random& random) {
  constexpr Lane16 kEnds[] = {0, 1, 2, 0x7FFE, 0x7FFF, 0x8000, 0x8001, 0xFFFE, 0xFFFF};
  return chance(random, 3) ? kEnds[random() % 9] : low(static_cast<std::int64_t>(random()));
}
Lane32 dword(Random& random) { return word(random) | static_cast<Lane32>(word(random)) << 16; }

class VectorOpsOf : public testing::TestWithParam<Isa> {
 protected:
  /// op(a, b) is meant(a[lane], b[lane], lane) in every lane; `limit` masks the operands.
  template <typename Lane, typename Meant>
  void expect(const char* name, void (*op)(const Lane*, const Lane*, Lane*), Lane a_mask,
              Lane b_mask, Lane least, Meant&& meant) {
    for (int round = 0; round < 300; ++round) {
      alignas(64) Lane a[kLanes], b[kLanes], out[kLanes];
      for (unsigned l = 0; l < kLanes; ++l) {
        const Lane x = static_cast<Lane>(dword(random_)), y = static_cast<Lane>(dword(random_));
        a[l] = std::max<Lane>(x & a_mask, least);
        b[l] = std::max<Lane>(y & b_mask, least);
      }
      op(a, b, out);
      for (unsigned l = 0; l < kLanes; ++l) {
        ASSERT_EQ(out[l], meant(a, b, l)) << name << " of " << a[l] << " and " << b[l];
      }
    }
  }
  Random random_{81};
};

#define GICODEC_MEANS(name, a_mask, b_mask, least, expression)                        \
  expect(#name, ops.name, a_mask, b_mask, least, [](auto* a_, auto* b_, unsigned l) { \
    [[maybe_unused]] const auto a = a_[l], b = b_[l];                                 \
    return static_cast<std::remove_const_t<decltype(a)>>(expression);                 \
  })

TEST_P(VectorOpsOf, Words) {
  const auto& ops = kernels<VectorOps>(GetParam());
  constexpr Lane16 kAny = 0xFFFF, kNone = 0;
  GICODEC_MEANS(add, kAny, kAny, kNone, a + b);
  GICODEC_MEANS(sub, kAny, kAny, kNone, a - b);
  GICODEC_MEANS(add_sat, kAny, kAny, kNone, std::min(a + b, 0xFFFF));
  GICODEC_MEANS(mul_lo, kAny, kAny, kNone, static_cast<Lane32>(a) * b);
  GICODEC_MEANS(mul_high, kAny, kAny, kNone, static_cast<Lane32>(a) * b >> 16);
  GICODEC_MEANS(mul_rounded, kAny, kAny, kNone, (std::int64_t{sign(a)} * sign(b) + 16384) >> 15);
  GICODEC_MEANS(bit_and, kAny, kAny, kNone, a & b);
  GICODEC_MEANS(bit_or, kAny, kAny, kNone, a | b);
  GICODEC_MEANS(bit_xor, kAny, kAny, kNone, a ^ b);
  GICODEC_MEANS(min_u, kAny, kAny, kNone, std::min(a, b));
  GICODEC_MEANS(min_s, kAny, kAny, kNone, std::min(sign(a), sign(b)));
  GICODEC_MEANS(max_s, kAny, kAny, kNone, std::max(sign(a), sign(b)));
  GICODEC_MEANS(magnitude, kAny, kAny, kNone, std::abs(sign(a)));
  GICODEC_MEANS(shift_left_5, kAny, kAny, kNone, a << 5);
  GICODEC_MEANS(shift_right_5, kAny, kAny, kNone, a >> 5);
  GICODEC_MEANS(shift_arithmetic_5, kAny, kAny, kNone, sign(a) >> 5);
  GICODEC_MEANS(shift_left_all, kAny, Lane16{31}, kNone, std::uint64_t{a} << b_[0]);
  GICODEC_MEANS(shift_right_all, kAny, Lane16{31}, kNone, a >> b_[0]);
  GICODEC_MEANS(lookup16, Lane16{15}, kAny, kNone, kNibbles.entry[a]);
  GICODEC_MEANS(widen_narrow, kAny, kAny, kNone, a);
  GICODEC_MEANS(select_equal, Lane16{3}, Lane16{3}, kNone, a == b ? a : -7);
  GICODEC_MEANS(keep_greater, kAny, kAny, kNone, sign(a) > sign(b) ? a : 0);
  GICODEC_MEANS(mask_and, kAny, kAny, kNone, sign(a) > sign(b) && sign(a) > 0 ? a : b);
  GICODEC_MEANS(mask_or, kAny, kAny, kNone, sign(a) > sign(b) || sign(a) > 0 ? a : b);
  GICODEC_MEANS(mask_andnot, kAny, kAny, kNone, sign(a) > sign(b) && sign(a) <= 0 ? a : b);
  GICODEC_MEANS(by_bits, kAny, kAny, kNone,
                ((b_[0] | static_cast<Lane32>(b_[1]) << 16) >> l & 1) != 0 ? a : b);
}

TEST_P(VectorOpsOf, Bytes) {
  const auto& ops = kernels<VectorOps>(GetParam());
  constexpr Lane16 kAny = 0xFF, kNone = 0;
  GICODEC_MEANS(bytes_words, kAny, kAny, kNone, a);
  GICODEC_MEANS(set8, kAny, kAny, kNone, 0xFD);
  GICODEC_MEANS(add8, kAny, kAny, kNone, (a + b) & 0xFF);
  GICODEC_MEANS(sub8, kAny, kAny, kNone, (a - b) & 0xFF);
  GICODEC_MEANS(min_u8, kAny, kAny, kNone, std::min(a, b));
  GICODEC_MEANS(select8, kAny, kAny, kNone, a <= b ? a : 0x5A);
  GICODEC_MEANS(select8, Lane16{3}, Lane16{3}, kNone, a <= b ? a : 0x5A);
  GICODEC_MEANS(add_where, kAny, kAny, kNone, (a <= b ? a + 37 : a) & 0xFF);
  GICODEC_MEANS(store8, kAny, kAny, kNone, a);
  GICODEC_MEANS(lookup16_8, Lane16{15}, kAny, kNone, kBytes16.entry[a]);
  GICODEC_MEANS(lookup64_8, Lane16{63}, kAny, kNone, kBytes64.entry[a]);
  GICODEC_MEANS(lookup256_8, kAny, kAny, kNone, kBytes256.entry[a]);
  GICODEC_MEANS(lookup_quarter, Lane16{15}, Lane16{3}, kNone, kBytes64.entry[16 * b + a]);
}

TEST_P(VectorOpsOf, Dwords) {
  const auto& ops = kernels<VectorOps>(GetParam());
  constexpr Lane32 kAny = 0xFFFFFFFF, kNone = 0;
  GICODEC_MEANS(add32, kAny, kAny, kNone, a + b);
  GICODEC_MEANS(sub32, kAny, kAny, kNone, a - b);
  GICODEC_MEANS(mul_lo32, kAny, kAny, kNone, a * b);
  GICODEC_MEANS(bit_and32, kAny, kAny, kNone, a & b);
  GICODEC_MEANS(bit_or32, kAny, kAny, kNone, a | b);
  GICODEC_MEANS(shift_left32, kAny, Lane32{31}, kNone, a << b);
  GICODEC_MEANS(shift_left_9, kAny, kAny, kNone, a << 9);
  GICODEC_MEANS(shift_right_9, kAny, kAny, kNone, a >> 9);
  GICODEC_MEANS(select32, kAny, kAny, kNone, (b_[0] >> l & 1) != 0 ? a : 0xFEDCBA98);
  GICODEC_MEANS(quotient, Lane32{0xFFFFF}, Lane32{0xFFFF}, Lane32{1}, a / b);
  GICODEC_MEANS(quotient, kAny, Lane32{0xFFFF}, Lane32{0x1001}, a / b);
  GICODEC_MEANS(collect, kAny, kAny, kNone, a ^ b_[31 - l]);
}

/// Of dividends up to the last one below 2^20 times the divisor, and on both sides of multiples.
TEST_P(VectorOpsOf, Quotients) {
  const auto& ops = kernels<VectorOps>(GetParam());
  for (int round = 0; round < 3000; ++round) {
    alignas(64) Lane32 a[kLanes], b[kLanes], out[kLanes];
    for (unsigned l = 0; l < kLanes; ++l) {
      b[l] = pick(random_, 1, chance(random_, 2) ? 16 : 0xFFFF);
      const std::uint64_t most =
          std::min((std::uint64_t{b[l]} << 20) - 1, std::uint64_t{UINT32_MAX});
      const std::uint64_t some = random_() % (most + 1), multiple = some - some % b[l];
      const std::uint64_t choices[] = {some, most, multiple, multiple == 0 ? 0 : multiple - 1};
      a[l] = static_cast<Lane32>(choices[random_() % 4]);
    }
    ops.quotient(a, b, out);
    for (unsigned l = 0; l < kLanes; ++l) ASSERT_EQ(out[l], a[l] / b[l]) << a[l] << " / " << b[l];
  }
}

TEST_P(VectorOpsOf, BitsOfLanes) {
  const auto& ops = kernels<VectorOps>(GetParam());
  for (int round = 0; round < 300; ++round) {
    alignas(64) Lane16 a[kLanes], b[kLanes];
    Lane32 greater = 0;
    for (unsigned l = 0; l < kLanes; ++l) {
      a[l] = word(random_);
      b[l] = word(random_);
      greater |= static_cast<Lane32>(sign(a[l]) > sign(b[l])) << l;
    }
    EXPECT_EQ(ops.to_bits(a, b), greater);
  }
}

/// Words go into lanes in order and come out in reverse.
TEST_P(VectorOpsOf, WordsOfStates) {
  const auto& ops = kernels<VectorOps>(GetParam());
  for (int round = 0; round < 300; ++round) {
    const auto active = chance(random_, 3) ? 0xFFFFFFFF : dword(random_);
    const auto words = noise(random_, 192);  // Whole vectors are read.
    alignas(64) Lane16 high[kLanes], bottom[kLanes];
    alignas(64) Lane32 x[kLanes], expected[kLanes], limit[kLanes];
    std::size_t taken = 0;
    for (unsigned l = 0; l < kLanes; ++l) {
      high[l] = chance(random_, 2) ? Lane16{0} : word(random_);
      bottom[l] = word(random_);
      expected[l] = bottom[l] | static_cast<Lane32>(high[l]) << 16;
      if ((active >> l & 1) == 0 || high[l] != 0) continue;
      Lane16 next;
      std::memcpy(&next, words.data() + taken, 2);
      expected[l] = expected[l] << 16 | next;
      taken += 2;
    }
    const auto* begin = reinterpret_cast<const std::uint8_t*>(words.data());
    EXPECT_EQ(ops.refill(high, bottom, active, begin), begin + taken);
    for (unsigned l = 0; l < kLanes; ++l) {
      ASSERT_EQ(bottom[l] | static_cast<Lane32>(high[l]) << 16, expected[l]) << l;
    }

    std::uint8_t out[192] = {}, expected_out[64] = {};
    std::size_t put = 0;
    for (unsigned l = kLanes; l-- > 0;) {
      expected[l] = x[l] = dword(random_);
      limit[l] = chance(random_, 2) ? x[l] + pick(random_, 0, 1) : dword(random_);
      if ((active >> l & 1) == 0 || x[l] < limit[l]) continue;
      const Lane16 word = low(x[l]);
      put += 2;
      std::memcpy(expected_out + 64 - put, &word, 2);
      expected[l] = x[l] >> 16;
    }
    EXPECT_EQ(ops.spill(x, limit, active, out + 192), out + 192 - put);
    EXPECT_EQ(std::memcmp(x, expected, sizeof x), 0);
    EXPECT_EQ(std::memcmp(out + 192 - put, expected_out + 64 - put, put), 0);
  }
}

TEST_P(VectorOpsOf, BytesInTurn) {
  const auto& ops = kernels<VectorOps>(GetParam());
  std::vector<std::uint8_t> bytes(3 * ops.triples), back(bytes.size());
  std::vector<std::uint8_t> y(ops.triples), u(ops.triples), v(ops.triples);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random_());
  ops.split3(bytes.data(), y.data(), u.data(), v.data());
  for (std::size_t i = 0; i < ops.triples; ++i) {
    ASSERT_EQ(y[i], bytes[3 * i]);
    ASSERT_EQ(u[i], bytes[3 * i + 1]);
    ASSERT_EQ(v[i], bytes[3 * i + 2]);
  }
  ops.join3(y.data(), u.data(), v.data(), back.data());
  EXPECT_EQ(back, bytes);
}

INSTANTIATE_TEST_SUITE_P(Isa, VectorOpsOf, testing::ValuesIn(supported_isas()),
                         [](const auto& test) { return std::string(to_string(test.param)); });

}  // namespace
}  // namespace gicodec::test
