// The operations of the vector wrappers (simd/vector.h), for tests: compiled once per instruction
// set like any kernel.
#pragma once

#include "simd/dispatch.h"
#include "simd/vector.h"

#include <cstddef>
#include <cstdint>

namespace gicodec::test {

/// On 32 lanes of 16 or 32 bits each. What all lanes shift by, and bits of lanes, begin in b[0].
struct VectorOps {
  using Words = void (*)(const std::uint16_t* a, const std::uint16_t* b, std::uint16_t* out);
  using Dwords = void (*)(const std::uint32_t* a, const std::uint32_t* b, std::uint32_t* out);
  Words add, sub, add_sat, mul_lo, mul_rounded, bit_and, bit_or, bit_xor, min_u, max_s, magnitude,
      shift_left_5, shift_right_5, shift_arithmetic_5, shift_left_all, shift_right_all, lookup16,
      lookup64, widen_narrow, select_equal, keep_greater, mask_and, mask_or, mask_andnot, by_bits;
  Dwords add32, sub32, mul_lo32, bit_and32, bit_or32, shift_left32, shift_right32, shift_left_9,
      shift_right_9, select32, quotient, log2_floor, collect;
  std::uint32_t (*to_bits)(const std::uint16_t* a, const std::uint16_t* b);  ///< of a > b
  std::uint32_t (*sum_lanes)(const std::uint16_t* a);
  const std::uint8_t* (*refill)(std::uint32_t* x, std::uint32_t active, const std::uint8_t* next);
  std::uint8_t* (*spill)(std::uint32_t* x, const std::uint32_t* limit, std::uint32_t active,
                         std::uint8_t* next);
  std::size_t triples;
  void (*split3)(const std::uint8_t* from, std::uint8_t* y, std::uint8_t* u, std::uint8_t* v);
  void (*join3)(const std::uint8_t* y, const std::uint8_t* u, const std::uint8_t* v,
                std::uint8_t* to);
};

/// What lookup16 and lookup64 look into.
inline constexpr NibbleTable kNibbles{{0, 7, 3, 250, 4, 9, 1, 16, 32, 64, 128, 255, 99, 98, 97, 2}};
struct Table64 {
  alignas(64) std::uint16_t entry[64];
};
constexpr Table64 make_table64() {
  Table64 table{};
  for (unsigned i = 0; i < 64; ++i) table.entry[i] = static_cast<std::uint16_t>(i * 40503U);
  return table;
}
inline constexpr Table64 kTable64 = make_table64();

}  // namespace gicodec::test
