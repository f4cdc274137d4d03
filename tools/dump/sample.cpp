#include "dump/sample.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

namespace gicodec::tools {

std::uint32_t shared_exponent_sample(SampleType type, std::uint32_t mantissa,
                                     std::uint32_t exponent) noexcept {
  const float value = std::ldexp(static_cast<float>(mantissa), static_cast<int>(exponent) - 24);
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return type == SampleType::half ? narrow_float(bits).value_or(0) : bits;
}

std::optional<std::array<std::uint32_t, 4>> shared_exponent_codes(
    const std::array<SampleType, 3>& types, const std::array<std::uint32_t, 3>& samples) noexcept {
  constexpr float kLargest = 65408;  // 511 · 2^7
  std::array<float, 3> values{};
  float most = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t bits = types[i] == SampleType::half ? widen_half(samples[i]) : samples[i];
    values[i] = std::bit_cast<float>(bits);
    if (std::signbit(values[i]) || !(values[i] <= kLargest)) return std::nullopt;
    most = std::max(most, values[i]);
  }
  std::array<std::uint32_t, 4> codes{};
  // Higher exponents have coarser steps.
  while (std::ldexp(most, 24 - static_cast<int>(codes[3])) >= 512) ++codes[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const float mantissa = std::ldexp(values[i], 24 - static_cast<int>(codes[3]));
    codes[i] = static_cast<std::uint32_t>(mantissa);
    if (static_cast<float>(codes[i]) != mantissa) return std::nullopt;
  }
  return codes;
}

std::string sample_text(SampleType type, std::uint32_t sample) {
  if (type == SampleType::uint32) return fmt::format("{}", sample);
  const bool half = type == SampleType::half;
  const float value = std::bit_cast<float>(half ? widen_half(sample) : sample);
  if (std::isfinite(value)) return fmt::format("{}", value);
  return half ? fmt::format("{} (0x{:04X})", value, sample)
              : fmt::format("{} (0x{:08X})", value, sample);
}

std::string_view to_string(SampleType type) noexcept {
  switch (type) {
    case SampleType::uint32:
      return "UINT";
    case SampleType::half:
      return "HALF";
    case SampleType::float32:
      return "FLOAT";
  }
  return {};
}

std::optional<SampleType> sample_type_from_string(std::string_view name) noexcept {
  for (const SampleType type : {SampleType::uint32, SampleType::half, SampleType::float32}) {
    if (name == to_string(type)) return type;
  }
  return std::nullopt;
}

// One word of the texel holds the component, which never crosses a 32-bit boundary.
std::uint32_t load_component(const std::byte* texel, std::size_t texel_bytes,
                             const Component& component) noexcept {
  const std::size_t word = std::size_t{component.offset / 32U} * 4;
  std::uint32_t bits = 0;
  std::memcpy(&bits, texel + word, std::min<std::size_t>(4, texel_bytes - word));
  return bits >> (component.offset % 32) & max_code(component);
}

void store_component(std::byte* texel, std::size_t texel_bytes, const Component& component,
                     std::uint32_t code) noexcept {
  const std::size_t word = std::size_t{component.offset / 32U} * 4;
  const std::size_t size = std::min<std::size_t>(4, texel_bytes - word);
  std::uint32_t bits = 0;
  std::memcpy(&bits, texel + word, size);
  bits |= code << (component.offset % 32);
  std::memcpy(texel + word, &bits, size);
}

}  // namespace gicodec::tools
