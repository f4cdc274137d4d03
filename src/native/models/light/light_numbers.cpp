#include "native/models/light/light_numbers.h"

#include <cstring>

namespace gicodec::native {
namespace {

constexpr std::int64_t kSnormUnit = 132104;  // 2^24 / 127
constexpr int kSharedShift = 27;
constexpr int kColorShift = 35;  // of a float's 1, which its fraction is part of
constexpr std::int32_t kMaxMantissa = 511;
constexpr unsigned kFloatFraction = 23, kHalfFraction = 10;

/// Floats of that many bits as numbers of the same order, zeros of both signs distinct.
std::int32_t ordered(std::uint32_t bits, unsigned of) {
  const std::uint32_t sign = 1U << (of - 1);
  return static_cast<std::int32_t>((bits & sign) != 0 ? ~(bits & (sign - 1)) : bits);
}
std::uint32_t from_ordered(std::int32_t code, unsigned of) {
  const auto bits = static_cast<std::uint32_t>(code);
  return code < 0 ? (~bits & ((1U << (of - 1)) - 1)) | 1U << (of - 1) : bits;
}

struct Parts {
  int exponent;  ///< from 1 on
  std::int64_t mantissa;
};
/// Of a float's magnitude, by the bits of its fraction; what is not finite counts as the largest.
Parts parts_of(std::uint32_t bits, unsigned fraction) {
  const bool half = fraction == kHalfFraction;
  bits = std::min(bits & (half ? 0x7FFFU : 0x7FFFFFFFU), half ? 0x7BFFU : 0x7F7FFFFFU);
  const auto exponent = static_cast<int>(bits >> fraction);
  const std::int64_t below = bits & ((1U << fraction) - 1);
  return exponent == 0 ? Parts{1, below} : Parts{exponent, below | 1 << fraction};
}
/// The float below a mantissa of any width times 2^exponent, as parts_of() returns them.
std::uint32_t to_bits(std::int64_t mantissa, int exponent, unsigned fraction) {
  const bool half = fraction == kHalfFraction;
  const int excess = static_cast<int>(width_of(mantissa)) - static_cast<int>(fraction + 1);
  if (mantissa <= 0) return 0;
  exponent += excess;
  if (exponent > (half ? 30 : 254)) return half ? 0x7BFF : 0x7F7FFFFF;
  const int shift = exponent < 1 ? excess + 1 - exponent : excess;
  const std::int64_t cut = shift > 62 ? 0 : shift > 0 ? mantissa >> shift : mantissa << -shift;
  // What has the leading bit adds 1 to the exponent.
  return static_cast<std::uint32_t>(cut) +
         (static_cast<std::uint32_t>(std::max(exponent, 1) - 1) << fraction);
}

std::int64_t shifted(std::int64_t value, int left) {
  if (left < 0 || value == 0) return left < -62 ? 0 : value >> std::max(-left, 0);
  return static_cast<int>(width_of(value)) + left > 41 ? kMaxColor : value << left;
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

LightEncoding::LightEncoding(const Record& record)
    : bytes_(record.bytes),
      shared_(record.bytes == 7 || record.bytes == 4),
      directed_(record.bytes == 7 || record.bytes == 24),
      color_bits_(shared_     ? 9
                  : directed_ ? 32
                              : 16),
      fraction_(directed_ ? kFloatFraction : kHalfFraction) {}

std::uint8_t LightEncoding::lit(const std::byte* records) const {
  constexpr std::size_t kColorBytes = 6;  // of halves, before alpha
  std::uint8_t lit = 0;
  for (unsigned h = 0; h < kHemispheres; ++h) {
    std::uint64_t colors = 0;
    std::memcpy(&colors, records + h * bytes_, shared_ ? bytes_ : kColorBytes);
    if (colors != 0) lit |= static_cast<std::uint8_t>(1U << h);
  }
  return lit;
}

LightCodes LightEncoding::read(const std::byte* record) const {
  LightCodes codes;
  if (alpha()) {
    const std::array<std::uint32_t, 2> words{word_at(record), word_at(record + 4)};
    const auto half = [&](unsigned i) {
      return ordered(words[i / 2] >> (16 * (i % 2)) & 0xFFFF, 16);
    };
    codes.color = {half(0), half(1), half(2)};
    codes.alpha = half(3);
    return codes;
  }
  const std::uint32_t first = word_at(record);
  for (unsigned i = 0; i < 3; ++i) {
    if (shared_) {
      codes.color[i] = static_cast<std::int32_t>(first >> (9 * i) & kMaxMantissa);
      // NOLINTNEXTLINE(bugprone-signed-char-misuse): its sign is wanted.
      if (directed_) codes.direction[i] = static_cast<std::int8_t>(record[4 + i]);
    } else {
      codes.color[i] = ordered(word_at(record + std::size_t{4} * i), 32);
      codes.direction[i] = ordered(word_at(record + 12 + std::size_t{4} * i), 32);
    }
  }
  if (shared_) codes.exponent = static_cast<std::int32_t>(first >> 27);
  return codes;
}

void LightEncoding::write(const LightCodes& codes, std::byte* record) const {
  if (alpha()) {
    const auto half = [](std::int32_t code) { return from_ordered(code, 16); };
    put_word(half(codes.color[0]) | half(codes.color[1]) << 16, record);
    put_word(half(codes.color[2]) | half(codes.alpha) << 16, record + 4);
    return;
  }
  auto first = static_cast<std::uint32_t>(codes.exponent) << 27;
  for (unsigned i = 0; i < 3; ++i) {
    if (shared_) {
      first |= static_cast<std::uint32_t>(codes.color[i]) << (9 * i);
      if (directed_) record[4 + i] = static_cast<std::byte>(codes.direction[i]);
    } else {
      put_word(from_ordered(codes.color[i], 32), record + std::size_t{4} * i);
      put_word(from_ordered(codes.direction[i], 32), record + 12 + std::size_t{4} * i);
    }
  }
  if (shared_) put_word(first, record);
}

int LightEncoding::default_top() const { return shared_ ? 16 : directed_ ? 127 : 15; }

int LightEncoding::top(const LightCodes& codes) const {
  if (shared_) {
    const bool dark = codes.color == std::array<std::int32_t, 3>{};
    return dark ? 0 : codes.exponent;
  }
  int top = 0;
  for (const std::int32_t code : codes.color) {
    if (code <= 0) continue;
    top = std::max(top, parts_of(static_cast<std::uint32_t>(code), fraction_).exponent);
  }
  return top;
}

HemisphereLight LightEncoding::light(const LightCodes& codes, int top) const {
  HemisphereLight out;
  for (unsigned i = 0; i < 3; ++i) {
    if (directed_) out.direction[i] = direction_of(codes.direction[i]);
    out.color[i] = color_of(codes.color[i], codes.exponent, top);
  }
  return out;
}

std::int64_t LightEncoding::direction_of(std::int32_t code) const {
  if (shared_) return code * kSnormUnit;
  const std::uint32_t bits = from_ordered(code, 32);
  const Parts parts = parts_of(bits, kFloatFraction);
  // 1 is 2^23 with the exponent 127.
  const std::int64_t length =
      std::min(shifted(parts.mantissa, parts.exponent - 126), kMaxDirection);
  return (bits >> 31) != 0 ? -length : length;
}

std::int64_t LightEncoding::color_of(std::int32_t code, int exponent, int top) const {
  if (shared_) return shifted(code, exponent - top + kSharedShift);
  if (code <= 0) return 0;
  const Parts parts = parts_of(static_cast<std::uint32_t>(code), fraction_);
  return shifted(parts.mantissa, parts.exponent - top + kColorShift - static_cast<int>(fraction_));
}

LightEncoding::Predicted LightEncoding::direction_code(std::int64_t coordinate) const {
  if (!shared_) {
    const std::uint32_t bits = to_bits(std::abs(coordinate), 126, kFloatFraction);
    return {ordered(coordinate < 0 ? bits | 0x80000000U : bits, 32), 0};
  }
  constexpr std::int64_t kMax = 127;
  const std::int64_t quarters = (coordinate * kMax + kUnitLength / 2) >> 22;
  return {static_cast<std::int32_t>(std::clamp(quarters >> 2, -kMax, kMax)),
          static_cast<std::uint32_t>(quarters & 3)};
}

std::int32_t LightEncoding::color_of_bits(std::int64_t code) const {
  const auto bits = static_cast<std::uint32_t>(code);
  if (shared_) return static_cast<std::int32_t>(bits & static_cast<std::uint32_t>(kMaxMantissa));
  return static_cast<std::int32_t>(signed_of(bits, color_bits_));
}

std::int32_t LightEncoding::color_code(std::int64_t color, int exponent, int top) const {
  if (!shared_) {
    const int shift = kColorShift - static_cast<int>(fraction_);
    return static_cast<std::int32_t>(to_bits(color, top - shift, fraction_));
  }
  const std::int64_t steps = in_steps(color, exponent - top + kSharedShift);
  return static_cast<std::int32_t>(std::min<std::int64_t>(steps, kMaxMantissa));
}

int LightEncoding::exponent_of(std::int64_t brightest, int top) const {
  constexpr int kMax = 31;
  int exponent = 0;
  while (exponent < kMax && in_steps(brightest, exponent - top + kSharedShift) > kMaxMantissa) {
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
