#include "native/vector_numbers.h"

#include <cstring>

namespace gicodec::native {
namespace {

constexpr std::int64_t kSnormUnit = 132104;  // 2^24 / 127
constexpr int kQuantisedShift = 27, kFloatShift = 12;
constexpr std::int32_t kMostMantissa = 511;
constexpr unsigned kFraction = 23;  // bits of a float's

/// Floats as numbers of the same order, zeros of both signs apart.
std::int32_t ordered(std::uint32_t bits) {
  return static_cast<std::int32_t>((bits >> 31) != 0 ? ~(bits & 0x7FFFFFFFU) : bits);
}
std::uint32_t from_ordered(std::int32_t code) {
  const auto bits = static_cast<std::uint32_t>(code);
  return code < 0 ? ~bits | 0x80000000U : bits;
}

struct Parts {
  int exponent;  ///< 1 to 254
  std::int64_t mantissa;
};
/// Of a magnitude; what is not finite counts as the largest.
Parts parts_of(std::uint32_t bits) {
  constexpr std::uint32_t kLargest = 0x7F7FFFFF;
  bits = std::min(bits & 0x7FFFFFFFU, kLargest);
  const auto exponent = static_cast<int>(bits >> kFraction);
  const std::int64_t fraction = bits & ((1U << kFraction) - 1);
  return exponent == 0 ? Parts{1, fraction} : Parts{exponent, fraction | 1 << kFraction};
}
/// The float below a mantissa of any width times 2^exponent, as parts_of() tells them.
std::uint32_t to_bits(std::int64_t mantissa, int exponent) {
  const int excess = static_cast<int>(width_of(mantissa)) - static_cast<int>(kFraction + 1);
  if (mantissa <= 0) return 0;
  exponent += excess;
  if (exponent > 254) return 0x7F7FFFFF;
  const int shift = exponent < 1 ? excess + 1 - exponent : excess;
  const std::int64_t cut = shift > 62 ? 0 : shift > 0 ? mantissa >> shift : mantissa << -shift;
  // What has the leading bit adds 1 to the exponent.
  return static_cast<std::uint32_t>(cut) +
         (static_cast<std::uint32_t>(std::max(exponent, 1) - 1) << kFraction);
}

std::int64_t shifted(std::int64_t value, int left) {
  if (left < 0 || value == 0) return left < -62 ? 0 : value >> std::max(-left, 0);
  return static_cast<int>(width_of(value)) + left > 41 ? kMostColor : value << left;
}

std::uint32_t word_at(const std::byte* at) {
  std::uint32_t bits = 0;
  for (unsigned i = 0; i < 4; ++i) bits |= std::to_integer<std::uint32_t>(at[i]) << (8 * i);
  return bits;
}
void put_word(std::uint32_t bits, std::byte* at) {
  for (unsigned i = 0; i < 4; ++i) at[i] = static_cast<std::byte>(bits >> (8 * i));
}

}  // namespace

VectorCodes VectorForm::read(const std::byte* record) const {
  VectorCodes codes;
  const std::uint32_t first = word_at(record);
  for (unsigned i = 0; i < 3; ++i) {
    if (floats_) {
      codes.color[i] = ordered(word_at(record + std::size_t{4} * i));
      codes.direction[i] = ordered(word_at(record + 12 + std::size_t{4} * i));
    } else {
      codes.color[i] = static_cast<std::int32_t>(first >> (9 * i) & kMostMantissa);
      codes.direction[i] = static_cast<std::int8_t>(record[4 + i]);
    }
  }
  if (!floats_) codes.exponent = static_cast<std::int32_t>(first >> 27);
  return codes;
}

void VectorForm::write(const VectorCodes& codes, std::byte* record) const {
  auto first = static_cast<std::uint32_t>(codes.exponent) << 27;
  for (unsigned i = 0; i < 3; ++i) {
    if (floats_) {
      put_word(from_ordered(codes.color[i]), record + std::size_t{4} * i);
      put_word(from_ordered(codes.direction[i]), record + 12 + std::size_t{4} * i);
    } else {
      first |= static_cast<std::uint32_t>(codes.color[i]) << (9 * i);
      record[4 + i] = static_cast<std::byte>(codes.direction[i]);
    }
  }
  if (!floats_) put_word(first, record);
}

int VectorForm::top(const VectorCodes& codes) const {
  if (!floats_) {
    const bool dark = codes.color == std::array<std::int32_t, 3>{};
    return dark ? 0 : codes.exponent;
  }
  int top = 0;
  for (const std::int32_t code : codes.color) {
    if (code > 0) top = std::max(top, parts_of(from_ordered(code)).exponent);
  }
  return top;
}

HemisphereLight VectorForm::light(const VectorCodes& codes, int top) const {
  HemisphereLight out;
  for (unsigned i = 0; i < 3; ++i) {
    out.direction[i] = direction_of(codes.direction[i]);
    out.color[i] = color_of(codes.color[i], codes.exponent, top);
  }
  return out;
}

std::int64_t VectorForm::direction_of(std::int32_t code) const {
  if (!floats_) return code * kSnormUnit;
  const std::uint32_t bits = from_ordered(code);
  const Parts parts = parts_of(bits);
  // 1 is 2^23 with the exponent 127.
  const std::int64_t length =
      std::min(shifted(parts.mantissa, parts.exponent - 126), kMostDirection);
  return (bits >> 31) != 0 ? -length : length;
}

std::int64_t VectorForm::color_of(std::int32_t code, int exponent, int top) const {
  if (!floats_) return shifted(code, exponent - top + kQuantisedShift);
  if (code <= 0) return 0;
  const Parts parts = parts_of(from_ordered(code));
  return shifted(parts.mantissa, parts.exponent - top + kFloatShift);
}

VectorForm::Predicted VectorForm::direction_code(std::int64_t coordinate) const {
  if (floats_) {
    const std::uint32_t bits = to_bits(std::abs(coordinate), 126);
    return {ordered(coordinate < 0 ? bits | 0x80000000U : bits), 0};
  }
  constexpr std::int64_t kMost = 127;
  const std::int64_t quarters = (coordinate * kMost + kUnitLength / 2) >> 22;
  return {static_cast<std::int32_t>(std::clamp(quarters >> 2, -kMost, kMost)),
          static_cast<std::uint32_t>(quarters & 3)};
}

std::int32_t VectorForm::color_code(std::int64_t color, int exponent, int top) const {
  if (floats_) return ordered(to_bits(color, top - kFloatShift));
  const std::int64_t steps = in_steps(color, exponent - top + kQuantisedShift);
  return static_cast<std::int32_t>(std::min<std::int64_t>(steps, kMostMantissa));
}

int VectorForm::exponent_of(std::int64_t brightest, int top) const {
  constexpr int kMost = 31;
  int exponent = 0;
  while (exponent < kMost &&
         in_steps(brightest, exponent - top + kQuantisedShift) > kMostMantissa) {
    ++exponent;
  }
  return exponent;
}

std::int64_t root_of(std::int64_t value) {
  const auto whole = static_cast<std::uint64_t>(value);
  std::uint64_t root = 0;
  for (std::uint64_t bit = std::uint64_t{1} << 31; bit != 0; bit >>= 1) {
    if ((root | bit) * (root | bit) <= whole) root |= bit;
  }
  return static_cast<std::int64_t>(root);
}

Direction normalised(Direction v, std::size_t along, bool negative, std::int64_t& length) {
  constexpr int kDigits = 30;
  if (negative ? v[along] > 0 : v[along] < 0) v[along] = 0;
  std::int64_t most = 0;
  for (const std::int64_t c : v) most = std::max(most, std::abs(c));
  const int shift = std::max(0, static_cast<int>(width_of(most)) - kDigits);
  std::int64_t squares = 0;
  for (std::int64_t& c : v) {
    c = c < 0 ? -(-c >> shift) : c >> shift;
    squares += c * c;
  }
  const std::int64_t root = root_of(squares);
  length = root << shift;
  if (root == 0) {
    v = {};
    v[along] = negative ? -kUnitLength : kUnitLength;
    return v;
  }
  for (std::int64_t& c : v) c = c * kUnitLength / root;
  return v;
}

}  // namespace gicodec::native
