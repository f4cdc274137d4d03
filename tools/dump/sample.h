// Codes of a texel's components ↔ samples of image channels. Both are bit patterns in a uint32_t; a
// half is in the low 16 bits.
#pragma once

#include <gicodec/texture.h>

#include <Imath/half.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

namespace gicodec::tools {

enum class SampleType : std::uint8_t { uint32, half, float32 };

[[nodiscard]] constexpr std::uint32_t max_code(const Component& component) noexcept {
  return component.bits == 32 ? UINT32_MAX : (1U << component.bits) - 1;
}

/// A half as a float of the same value, by bits: NaN payloads survive.
[[nodiscard]] constexpr std::uint32_t widen_half(std::uint32_t half) noexcept {
  const std::uint32_t sign = (half & 0x8000U) << 16;
  std::uint32_t exponent = (half >> 10) & 0x1FU;
  std::uint32_t mantissa = half & 0x3FFU;
  if (exponent == 31) return sign | 0x7F800000U | mantissa << 13;
  if (exponent == 0) {
    if (mantissa == 0) return sign;
    const auto shift = static_cast<std::uint32_t>(std::countl_zero(mantissa) - 21);
    mantissa = mantissa << shift & 0x3FFU;
    exponent = 1 - shift;  // wraps; 112 is added below
  }
  return sign | (exponent + 112) << 23 | mantissa << 13;
}

/// The inverse; nullopt if no half has the float's value.
[[nodiscard]] constexpr std::optional<std::uint32_t> narrow_float(std::uint32_t bits) noexcept {
  const std::uint32_t sign = bits >> 16 & 0x8000U;
  const std::uint32_t exponent = bits >> 23 & 0xFFU;
  const std::uint32_t mantissa = bits & 0x7FFFFFU;
  std::uint32_t half = sign;
  if (exponent == 255) {
    half |= 0x7C00U | mantissa >> 13;
  } else if (exponent >= 113 && exponent <= 142) {
    half |= (exponent - 112) << 10 | mantissa >> 13;
  } else if (exponent >= 103 && exponent <= 112) {
    half |= (mantissa | 0x800000U) >> (126 - exponent);
  }
  if (widen_half(half) != bits) return std::nullopt;
  return half;
}

/// A component's name in channels and flags. Formats have names of one character.
[[nodiscard]] constexpr char letter(const Component& component) noexcept {
  return component.characters[0];
}

/// True if components of the record share an exponent.
[[nodiscard]] constexpr bool has_exponent(const Record& record) noexcept {
  for (const Component& component : record.used()) {
    if (component.type == ComponentType::exponent) return true;
  }
  return false;
}

/// True if a channel of that type can hold every code of the component. Mantissas and shared
/// exponents only fit UINT, since they mean nothing alone; so do integers, which may share a value.
[[nodiscard]] constexpr bool can_hold(SampleType type, const Component& component,
                                      const Record& record) noexcept {
  if (type == SampleType::uint32) return true;
  if (has_exponent(record)) return false;
  const bool half = type == SampleType::half;
  switch (component.type) {
    case ComponentType::unorm:
      return component.bits <= (half ? 10 : 16);
    case ComponentType::ufloat:
    case ComponentType::sfloat:
      return !half || component.bits <= 16;
    default:
      return false;
  }
}

/// The sample of a code. UINT: the code. HALF and FLOAT: n / (2^bits − 1), rounded, for unorm; the
/// float itself for floating-point components. Precondition: can_hold().
[[nodiscard]] inline std::uint32_t to_sample(SampleType type, const Component& component,
                                             std::uint32_t code) noexcept {
  if (type == SampleType::uint32) return code;
  const bool half = type == SampleType::half;
  if (component.type == ComponentType::unorm) {
    const float value = static_cast<float>(code) / static_cast<float>(max_code(component));
    return half ? Imath::half(value).bits() : std::bit_cast<std::uint32_t>(value);
  }
  if (component.bits == 32) return code;
  const std::uint32_t pattern =
      component.type == ComponentType::ufloat ? code << (15 - component.bits) : code;
  return half ? pattern : widen_half(pattern);
}

/// The inverse; nullopt for a sample that is no code, e.g. −0 for unorm.
[[nodiscard]] inline std::optional<std::uint32_t> to_code(SampleType type,
                                                          const Component& component,
                                                          std::uint32_t sample) noexcept {
  std::uint32_t code = sample;
  if (type != SampleType::uint32 && component.type == ComponentType::unorm) {
    const float value =
        std::bit_cast<float>(type == SampleType::half ? widen_half(sample) : sample);
    if (!(value >= 0 && value <= 1)) return std::nullopt;
    code = static_cast<std::uint32_t>(std::lrintf(value * static_cast<float>(max_code(component))));
  } else if (type != SampleType::uint32 && component.bits < 32) {
    if (type == SampleType::float32) {
      const auto narrow = narrow_float(sample);
      if (!narrow) return std::nullopt;
      code = *narrow;
    }
    if (component.type == ComponentType::ufloat) code >>= 15 - component.bits;
  }
  if (code > max_code(component) || to_sample(type, component, code) != sample) {
    return std::nullopt;
  }
  return code;
}

/// E5B9G9R9_UFLOAT_PACK32: the value of a mantissa as HALF or FLOAT, both of which hold it exactly.
[[nodiscard]] std::uint32_t shared_exponent_sample(SampleType type, std::uint32_t mantissa,
                                                   std::uint32_t exponent) noexcept;
/// The inverse: codes of R, G, B and E for three values, with the lowest possible exponent; nullopt
/// unless all values are exact.
[[nodiscard]] std::optional<std::array<std::uint32_t, 4>> shared_exponent_codes(
    const std::array<SampleType, 3>& types, const std::array<std::uint32_t, 3>& samples) noexcept;

/// The sample's value for messages, e.g. "0.3333", "-0", "nan (0x7E01)".
[[nodiscard]] std::string sample_text(SampleType type, std::uint32_t sample);
/// "UINT", "HALF" or "FLOAT".
[[nodiscard]] std::string_view to_string(SampleType type) noexcept;
[[nodiscard]] std::optional<SampleType> sample_type_from_string(std::string_view name) noexcept;

/// The code of a component in a texel of `texel_bytes` bytes.
[[nodiscard]] std::uint32_t load_component(const std::byte* texel, std::size_t texel_bytes,
                                           const Component& component) noexcept;
/// Stores a code. Precondition: the component's bits are zero.
void store_component(std::byte* texel, std::size_t texel_bytes, const Component& component,
                     std::uint32_t code) noexcept;

}  // namespace gicodec::tools
