// The operations of the vector wrappers (simd/vector.h), for tests: compiled once per instruction
// set like any kernel.
#pragma once

#include "simd/dispatch.h"
#include "simd/vector.h"

#include <cstddef>
#include <cstdint>

namespace gicodec::test {

/// On 32 lanes of 16 or 32 bits each; operations on bytes take and give words below 256. What all
/// lanes shift by, and bits of lanes, begin in b[0].
struct VectorOps {
  using Words = void (*)(const std::uint16_t* a, const std::uint16_t* b, std::uint16_t* out);
  using Dwords = void (*)(const std::uint32_t* a, const std::uint32_t* b, std::uint32_t* out);
  Words add, sub, add_sat, mul_lo, mul_high, mul_rounded, bit_and, bit_or, bit_xor, min_u, min_s,
      max_s, magnitude, shift_left_5, shift_right_5, shift_arithmetic_5, shift_left_all,
      shift_right_all, lookup16, widen_narrow, select_equal, keep_greater, mask_and, mask_or,
      mask_andnot, by_bits;
  Words bytes_words, set8, add8, sub8, min_u8, select8, add_where, store8, lookup16_8, lookup64_8,
      lookup256_8, lookup_quarter;
  Dwords add32, sub32, mul_lo32, bit_and32, bit_or32, shift_left32, shift_left_9, shift_right_9,
      select32, quotient, collect;
  std::uint32_t (*to_bits)(const std::uint16_t* a, const std::uint16_t* b);  ///< of a > b
  const std::uint8_t* (*refill)(std::uint16_t* high, std::uint16_t* low, std::uint32_t active,
                                const std::uint8_t* next);
  std::uint8_t* (*spill)(std::uint32_t* x, const std::uint32_t* limit, std::uint32_t active,
                         std::uint8_t* next);
  std::size_t triples;
  void (*split3)(const std::uint8_t* from, std::uint8_t* y, std::uint8_t* u, std::uint8_t* v);
  void (*join3)(const std::uint8_t* y, const std::uint8_t* u, const std::uint8_t* v,
                std::uint8_t* to);
};

/// What look-ups look into: of words, and of bytes, all of them others.
inline constexpr NibbleTable kNibbles{{0, 7, 3, 250, 4, 9, 1, 16, 32, 64, 128, 255, 99, 98, 97, 2}};
template <std::size_t n>
struct ByteTable {
  alignas(64) std::uint8_t entry[n];
};
template <std::size_t n>
constexpr ByteTable<n> make_byte_table() {
  ByteTable<n> table{};
  for (unsigned i = 0; i < n; ++i) table.entry[i] = static_cast<std::uint8_t>(i * 167 + 41);
  return table;
}
inline constexpr auto kBytes16 = make_byte_table<16>();
inline constexpr auto kBytes64 = make_byte_table<64>();
inline constexpr auto kBytes256 = make_byte_table<256>();

}  // namespace gicodec::test
