#include "payload/block_difference.h"

#include "payload/component_code.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace gicodec {
namespace {

/// Value of a small float: sign (if any), 5 bits of exponent, mantissa.
float small_float(std::uint32_t code, unsigned bits, bool has_sign) {
  const unsigned mantissa_bits = bits - 5 - (has_sign ? 1 : 0);
  const std::uint32_t mantissa = code & ((1U << mantissa_bits) - 1);
  const auto exponent = static_cast<int>(code >> mantissa_bits & 31U);
  const float sign = has_sign && code >> (bits - 1) != 0 ? -1.0F : 1.0F;
  if (exponent == 31) {
    return mantissa != 0 ? std::nanf("") : sign * std::numeric_limits<float>::infinity();
  }
  const int hidden = exponent == 0 ? 0 : 1 << mantissa_bits;
  const int scale = std::max(exponent, 1) - 15 - static_cast<int>(mantissa_bits);
  return sign * std::ldexp(static_cast<float>(hidden + static_cast<int>(mantissa)), scale);
}

float value_of(std::uint32_t code, const Component& component) {
  if (component.bits == 32) {
    float value = 0;
    std::memcpy(&value, &code, sizeof value);
    return value;
  }
  return small_float(code, component.bits, component.kind == ComponentKind::sfloat);
}

bool codes_differ(std::uint32_t a, std::uint32_t b, const Component& component, float threshold) {
  if (a == b) return false;
  if (component.kind == ComponentKind::opaque) return true;
  if (!is_float(component) || threshold >= 1) {
    const auto most = static_cast<float>(largest_code(component));
    return !near_enough(component, a, b, static_cast<std::uint32_t>(std::min(threshold, most / 2)));
  }
  const float x = value_of(a, component), y = value_of(b, component);
  const float scale = std::max(std::fabs(x), std::fabs(y));
  return !(std::fabs(x - y) <= threshold * scale);  // True for NaN and infinities.
}

template <typename Word>
float changed_words(std::span<const std::byte> a, std::span<const std::byte> b) noexcept {
  std::size_t changed = 0;
  for (std::size_t at = 0; at < a.size(); at += sizeof(Word)) {
    Word x = 0, y = 0;
    std::memcpy(&x, a.data() + at, sizeof x);
    std::memcpy(&y, b.data() + at, sizeof y);
    changed += x != y ? 1 : 0;
  }
  return static_cast<float>(changed * sizeof(Word)) / static_cast<float>(a.size());
}

}  // namespace

bool differs_by_more(const TextureDesc& desc, std::span<const std::byte> a,
                     std::span<const std::byte> b, float threshold) noexcept {
  if (std::memcmp(a.data(), b.data(), a.size()) == 0) return false;
  if (!(threshold > 0)) return true;
  const Record& record = desc.record;
  for (std::size_t at = 0; at < a.size(); at += record.bytes) {
    for (const Component& component : record.used()) {
      if (codes_differ(code_of(a.data() + at, component, record.bytes),
                       code_of(b.data() + at, component, record.bytes), component, threshold)) {
        return true;
      }
    }
  }
  return false;
}

float changed_share(const TextureDesc& desc, std::span<const std::byte> a,
                    std::span<const std::byte> b) noexcept {
  const unsigned size = desc.record.bytes;
  if (size % 8 == 0) return changed_words<std::uint64_t>(a, b);
  if (size % 4 == 0) return changed_words<std::uint32_t>(a, b);
  if (size % 2 == 0) return changed_words<std::uint16_t>(a, b);
  return changed_words<std::uint8_t>(a, b);
}

}  // namespace gicodec
