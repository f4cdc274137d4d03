#include "vector_ops.h"

#include "simd/intrinsics.h"

#include <algorithm>

namespace gicodec::test::GICODEC_ISA {
namespace {

#include GICODEC_VECTORS

#define GICODEC_WORDS(expression)                                            \
  [](const std::uint16_t* a_, const std::uint16_t* b_, std::uint16_t* out) { \
    [[maybe_unused]] const I16 a = load(a_), b = load(b_);                   \
    store(out, expression);                                                  \
  }
#define GICODEC_BYTES(expression)                                            \
  [](const std::uint16_t* a_, const std::uint16_t* b_, std::uint16_t* out) { \
    [[maybe_unused]] const B8 a = bytes(load(a_)), b = bytes(load(b_));      \
    store(out, words(expression));                                           \
  }
#define GICODEC_DWORDS(expression)                                           \
  [](const std::uint32_t* a_, const std::uint32_t* b_, std::uint32_t* out) { \
    [[maybe_unused]] const U32 a = load(a_), b = load(b_);                   \
    store(out, expression);                                                  \
  }

constexpr VectorOps kOps{
    GICODEC_WORDS(add(a, b)),
    GICODEC_WORDS(sub(a, b)),
    GICODEC_WORDS(add_sat(a, b)),
    GICODEC_WORDS(mul_lo(a, b)),
    GICODEC_WORDS(mul_high(a, b)),
    GICODEC_WORDS(mul_rounded(a, b)),
    GICODEC_WORDS(bit_and(a, b)),
    GICODEC_WORDS(bit_or(a, b)),
    GICODEC_WORDS(bit_xor(a, b)),
    GICODEC_WORDS(min_u(a, b)),
    GICODEC_WORDS(min_s(a, b)),
    GICODEC_WORDS(max_s(a, b)),
    GICODEC_WORDS(magnitude(a)),
    GICODEC_WORDS(shift_left<5>(a)),
    GICODEC_WORDS(shift_right<5>(a)),
    GICODEC_WORDS(shift_arithmetic<5>(a)),
    GICODEC_WORDS(shift_left_all(a, b_[0])),
    GICODEC_WORDS(shift_right_all(a, b_[0])),
    GICODEC_WORDS(lookup16(kNibbles, a)),
    GICODEC_WORDS(narrow(widen(a))),
    GICODEC_WORDS(select(equal(a, b), a, set(-7))),
    GICODEC_WORDS(keep(greater(a, b), a)),
    GICODEC_WORDS(select(mask_and(greater(a, b), greater(a, set(0))), a, b)),
    GICODEC_WORDS(select(mask_or(greater(a, b), greater(a, set(0))), a, b)),
    GICODEC_WORDS(select(mask_andnot(greater(a, b), greater(a, set(0))), a, b)),
    GICODEC_WORDS(select(from_bits(b_[0] | static_cast<std::uint32_t>(b_[1]) << 16), a, b)),
    GICODEC_WORDS(words(bytes(a))),
    GICODEC_BYTES(set8(-3)),
    GICODEC_BYTES(add(a, b)),
    GICODEC_BYTES(sub(a, b)),
    GICODEC_BYTES(min_u(a, b)),
    GICODEC_BYTES(select(at_most(a, b), a, set8(0x5A))),
    GICODEC_BYTES(add_where(at_most(a, b), a, 37)),
    [](const std::uint16_t* a, const std::uint16_t*, std::uint16_t* out) {
      std::uint8_t stored[kLanes];
      store(stored, bytes(load(a)));
      std::copy_n(stored, kLanes, out);
    },
    GICODEC_BYTES(lookup16(kBytes16.entry, a)),
    GICODEC_BYTES(lookup64(kBytes64.entry, a)),
    GICODEC_BYTES(lookup256(kBytes256.entry, a)),
    GICODEC_BYTES(lookup_quarter(kBytes64.entry, a, b, at_most(set8(1), b), at_most(set8(2), b),
                                 at_most(set8(3), b))),
    GICODEC_DWORDS(add(a, b)),
    GICODEC_DWORDS(sub(a, b)),
    GICODEC_DWORDS(mul_lo(a, b)),
    GICODEC_DWORDS(bit_and(a, b)),
    GICODEC_DWORDS(bit_or(a, b)),
    GICODEC_DWORDS(shift_left(a, b)),
    GICODEC_DWORDS(shift_left<9>(a)),
    GICODEC_DWORDS(shift_right<9>(a)),
    GICODEC_DWORDS(select(b_[0], a, set32(0xFEDCBA98))),
    GICODEC_DWORDS(quotient(a, b)),
    GICODEC_DWORDS(collect([&](unsigned l) { return a_[l] ^ b_[31 - l]; })),
    [](const std::uint16_t* a, const std::uint16_t* b) {
      return to_bits(greater(load(a), load(b)));
    },
    [](std::uint16_t* high, std::uint16_t* low, std::uint32_t active, const std::uint8_t* next) {
      I16 h = load(high), l = load(low);
      refill(h, l, active, next);
      store(high, h);
      store(low, l);
      return next;
    },
    [](std::uint32_t* x, const std::uint32_t* limit, std::uint32_t active, std::uint8_t* next) {
      store(x, spill(load(x), load(limit), active, next));
      return next;
    },
    kTriples,
    [](const std::uint8_t* from, std::uint8_t* y, std::uint8_t* u, std::uint8_t* v) {
      split3(from, {y, u, v});
    },
    [](const std::uint8_t* y, const std::uint8_t* u, const std::uint8_t* v, std::uint8_t* to) {
      join3({y, u, v}, to);
    }};

}  // namespace
}  // namespace gicodec::test::GICODEC_ISA

namespace gicodec {
template <>
constinit const test::VectorOps TableOf<test::VectorOps, Isa::GICODEC_ISA>::kernels =
    test::GICODEC_ISA::kOps;
}  // namespace gicodec
