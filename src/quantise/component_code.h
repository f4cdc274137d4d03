// Components of records as codes: integers whose distance is that of the values.
#pragma once

#include <gicodec/record.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace gicodec {

/// The word of a record that begins at a byte, zeros behind the record's end.
[[nodiscard]] inline std::uint32_t load_word(const std::byte* from, std::size_t left) noexcept {
  std::uint32_t word = 0;
  if (left >= 4) {
    std::memcpy(&word, from, 4);
  } else {
    std::memcpy(&word, from, left);
  }
  return word;
}
inline void store_word(std::byte* to, std::size_t left, std::uint32_t word) noexcept {
  if (left >= 4) {
    std::memcpy(to, &word, 4);
  } else {
    std::memcpy(to, &word, left);
  }
}

/// Bits of a component of a record of `bytes` bytes; it never crosses a 32-bit boundary.
[[nodiscard]] inline std::uint32_t code_of(const std::byte* record, const Component& component,
                                           std::size_t bytes) noexcept {
  const std::size_t first = std::size_t{component.offset / 32U} * 4;
  const std::uint32_t word = load_word(record + first, bytes - first);
  const unsigned shift = component.offset % 32U;
  return static_cast<std::uint32_t>(word >> shift & ((std::uint64_t{1} << component.bits) - 1));
}
inline void set_code(std::byte* record, const Component& component, std::size_t bytes,
                     std::uint32_t code) noexcept {
  const std::size_t first = std::size_t{component.offset / 32U} * 4;
  std::uint32_t word = load_word(record + first, bytes - first);
  const unsigned shift = component.offset % 32U;
  const auto mask = static_cast<std::uint32_t>((std::uint64_t{1} << component.bits) - 1) << shift;
  word = (word & ~mask) | code << shift;
  store_word(record + first, bytes - first, word);
}

[[nodiscard]] constexpr bool is_float(const Component& component) noexcept {
  return component.type == ComponentType::sfloat ||
         (component.type == ComponentType::ufloat && component.bits >= 10);
}
/// Of 5 bits, but for floats of 32.
[[nodiscard]] constexpr unsigned mantissa_bits(const Component& component) noexcept {
  if (component.bits == 32) return 23;
  return component.bits - 5U - (component.type == ComponentType::sfloat ? 1U : 0U);
}
[[nodiscard]] constexpr std::uint32_t sign_bit(const Component& component) noexcept {
  return component.type == ComponentType::sfloat ? 1U << (component.bits - 1U) : 0U;
}
[[nodiscard]] constexpr std::uint32_t largest_code(const Component& component) noexcept {
  return static_cast<std::uint32_t>((std::uint64_t{1} << component.bits) - 1);
}
/// Of infinity, without its sign.
[[nodiscard]] constexpr std::uint32_t infinity_code(const Component& component) noexcept {
  const std::uint32_t magnitude = largest_code(component) & ~sign_bit(component);
  return magnitude & ~((1U << mantissa_bits(component)) - 1);
}
/// Codes of two's complement as distances go, and back.
[[nodiscard]] constexpr std::uint32_t ordered(std::uint32_t code,
                                              const Component& component) noexcept {
  return component.type == ComponentType::snorm ? code ^ 1U << (component.bits - 1U) : code;
}

/// Whether a component is off by no more than that many codes or ULP. Floats have to be of one sign
/// and finite, and what is given as zero is exact.
[[nodiscard]] constexpr bool near_enough(const Component& component, std::uint32_t given,
                                         std::uint32_t code, std::uint32_t units) noexcept {
  if (given == code) return true;
  if (is_float(component)) {
    const std::uint32_t sign = sign_bit(component), infinity = infinity_code(component);
    const std::uint32_t magnitude = given & ~sign;
    if (magnitude == 0 || magnitude >= infinity || (code & ~sign) >= infinity) return false;
    if (((given ^ code) & sign) != 0) return false;
  }
  const std::uint32_t a = ordered(given, component), b = ordered(code, component);
  return (a > b ? a - b : b - a) <= units;
}

}  // namespace gicodec
