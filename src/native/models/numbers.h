// Arithmetic that the models of adaptive chunks share (docs/native.md, "Adaptive chunks").
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>

namespace gicodec::native {

inline constexpr std::uint64_t kMaxPrediction = std::uint64_t{1} << 41;

inline std::uint32_t largest(unsigned bits) {
  return static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
}
/// The highest `most` bits of a value of `bits`, or all it has.
inline std::uint32_t top_bits(std::uint32_t value, unsigned bits, unsigned most) {
  return bits > most ? value >> (bits - most) : value;
}
/// 0, −1, 1, −2, … as 0, 1, 2, 3, …: differences modulo 2^bits.
inline std::uint32_t folded(std::uint32_t difference, unsigned bits) {
  const std::uint32_t most = largest(bits);
  difference &= most;
  const bool negative = (difference >> (bits - 1) & 1) != 0;
  return (negative ? ~(difference << 1) : difference << 1) & most;
}
inline std::uint32_t unfolded(std::uint32_t value, unsigned bits) {
  const std::uint32_t half = value >> 1;
  return ((value & 1) != 0 ? ~half : half) & largest(bits);
}
/// Of a difference modulo 2^bits.
inline std::int64_t signed_of(std::uint32_t difference, unsigned bits) {
  difference &= largest(bits);
  const bool negative = (difference >> (bits - 1) & 1) != 0;
  return negative ? std::int64_t{difference} - (std::int64_t{1} << bits) : difference;
}

inline std::uint32_t width_of(std::int64_t value) {
  return static_cast<std::uint32_t>(std::bit_width(static_cast<std::uint64_t>(std::abs(value))));
}
/// Two steps an octave.
inline std::uint32_t half_octave(std::uint64_t value) {
  const auto width = static_cast<unsigned>(std::bit_width(value));
  if (width < 3) return static_cast<std::uint32_t>(value);
  return width * 2 + static_cast<std::uint32_t>(value >> (width - 2) & 1);
}
inline std::uint32_t sign_of(std::int64_t value) { return value < 0 ? 0 : value == 0 ? 1 : 2; }

/// value · to / from, for values and results up to kMaxPrediction; `from` is not 0.
inline std::uint64_t in_proportion(std::uint64_t value, std::uint64_t to, std::uint64_t from) {
  constexpr int kDigits = 16;
  constexpr std::uint64_t kMaxTo = (1U << 20) - 1;
  const int shift = std::max(0, static_cast<int>(std::bit_width(from)) - kDigits);
  // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): the shift leaves kDigits of its digits.
  return std::min(value * std::min(to >> shift, kMaxTo) / (from >> shift), kMaxPrediction);
}

}  // namespace gicodec::native
