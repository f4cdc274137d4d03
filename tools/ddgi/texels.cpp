#include "texels.h"

#include "dump/sample.h"

#include <Imath/half.h>

#include <array>
#include <bit>
#include <cstring>
#include <limits>

namespace gicodec::ddgi {
namespace {

constexpr std::array kColorFormats = {
    Format::A2R10G10B10_UNORM_PACK32, Format::A2B10G10R10_UNORM_PACK32,
    Format::R8G8B8A8_UNORM,           Format::R16G16B16A16_SFLOAT,
    Format::R32G32B32A32_SFLOAT,      Format::B10G11R11_UFLOAT_PACK32,
    Format::E5B9G9R9_UFLOAT_PACK32};
constexpr std::array kVisibilityFormats = {Format::R16G16_SFLOAT, Format::R32G32_SFLOAT};

constexpr float power5(float x) {
  const float x2 = x * x;
  return x2 * x2 * x;
}

/// Least linear value of each code. A table and multiplications instead of pow(): the same codes
/// with every C library.
const std::array<float, 1024>& thresholds() {
  static const auto table = [] {
    std::array<float, 1024> t{};
    for (std::size_t k = 1; k < t.size(); ++k) {
      t[k] = power5((static_cast<float>(k) - 0.5F) / 1023.0F);
    }
    return t;
  }();
  return table;
}

std::uint32_t word(const std::byte* texel) {
  std::uint32_t w = 0;
  std::memcpy(&w, texel, sizeof w);
  return w;
}

/// A float component's code as a number, and the nearest code of one.
float value_of(const Component& component, std::uint32_t code) {
  if (component.type == ComponentType::ufloat) return from_ufloat(code, component.bits);
  if (component.bits == 16) return from_half(static_cast<std::uint16_t>(code));
  return std::bit_cast<float>(code);
}
std::uint32_t code_of(const Component& component, float value) {
  if (component.type == ComponentType::ufloat) return to_ufloat(value, component.bits);
  if (component.bits == 16) return to_half(value);
  return std::bit_cast<std::uint32_t>(value);
}

float power_of_two(int exponent) { return std::ldexp(1.0F, exponent); }

}  // namespace

std::string_view to_string(Encoding encoding) noexcept {
  return encoding == Encoding::gamma5 ? "gamma5" : "linear";
}

std::optional<Encoding> encoding_from_string(std::string_view name) noexcept {
  for (const Encoding encoding : {Encoding::gamma5, Encoding::linear}) {
    if (name == to_string(encoding)) return encoding;
  }
  return std::nullopt;
}

Encoding usual_encoding(Format format) noexcept {
  const FormatInfo* info = find_format(format);
  const bool unorm = info != nullptr && info->record.components[0].type == ComponentType::unorm;
  return unorm ? Encoding::gamma5 : Encoding::linear;
}

std::span<const Format> color_formats() noexcept { return kColorFormats; }
std::span<const Format> visibility_formats() noexcept { return kVisibilityFormats; }

std::string names_of(std::span<const Format> formats) {
  std::string names;
  for (const Format format : formats) {
    if (!names.empty()) names += ", ";
    names += find_format(format)->name;
  }
  return names;
}

ColorTexels::ColorTexels(Format format, Encoding encoding) : record_(format), encoding_(encoding) {
  const Component& first = record_.components[0];
  if (first.type == ComponentType::unorm) unit_ = static_cast<float>(tools::max_code(first));
}

Vec3 ColorTexels::load(const std::byte* texel) const {
  if (unit_ > 1) {  // all such formats are one word
    const std::uint32_t bits = word(texel), mask = tools::max_code(record_.components[0]);
    const auto channel = [&](std::size_t i) {
      return static_cast<float>(bits >> record_.components[i].offset & mask);
    };
    return {channel(0), channel(1), channel(2)};
  }
  if (record_.format == Format::E5B9G9R9_UFLOAT_PACK32) return from_shared_exponent(word(texel));
  const auto channel = [&](std::size_t i) {
    const Component& component = record_.components[i];
    return value_of(component, tools::load_component(texel, record_.bytes, component));
  };
  return {channel(0), channel(1), channel(2)};
}

Vec3 ColorTexels::encode(Vec3 linear) const {
  const Vec3 v = unit_ > 1 ? min(linear, {1, 1, 1}) : linear;
  if (encoding_ == Encoding::linear) return v;
  return {fifth_root(v.x), fifth_root(v.y), fifth_root(v.z)};
}

Vec3 ColorTexels::encode(Vec3 linear, Vec3 guess) const {
  if (encoding_ == Encoding::linear || unit_ != 1023) return encode(linear);
  const auto channel = [](float value, float near) {
    return static_cast<float>(encode_gamma5(value, static_cast<std::uint32_t>(near))) / 1023.0F;
  };
  return {channel(linear.x, guess.x), channel(linear.y, guess.y), channel(linear.z, guess.z)};
}

void ColorTexels::store(std::byte* texel, Vec3 encoded) const {
  const float channels[4] = {encoded.x, encoded.y, encoded.z, 1};
  if (unit_ > 1 || record_.format == Format::E5B9G9R9_UFLOAT_PACK32) {
    std::uint32_t bits = 0;
    if (unit_ > 1) {
      for (std::size_t i = 0; i < 3; ++i) {
        const auto code =
            static_cast<std::uint32_t>(std::floor(saturate(channels[i]) * unit_ + 0.5F));
        bits |= code << record_.components[i].offset;
      }
    } else {
      bits = to_shared_exponent(encoded);
    }
    std::memcpy(texel, &bits, sizeof bits);
    return;
  }
  std::memset(texel, 0, record_.bytes);
  for (std::size_t i = 0; i < record_.count; ++i) {
    const Component& component = record_.components[i];
    tools::store_component(texel, record_.bytes, component, code_of(component, channels[i]));
  }
}

Vec2 load_moments(Format format, const std::byte* texel) {
  if (format == Format::R32G32_SFLOAT) {
    Vec2 moments;
    std::memcpy(&moments, texel, sizeof moments);
    return moments;
  }
  const std::uint32_t both = word(texel);
  return {from_half(static_cast<std::uint16_t>(both & 0xFFFFU)),
          from_half(static_cast<std::uint16_t>(both >> 16))};
}

void store_moments(Format format, std::byte* texel, Vec2 moments) {
  if (format == Format::R32G32_SFLOAT) {
    std::memcpy(texel, &moments, sizeof moments);
    return;
  }
  const std::uint16_t both[2] = {to_half(moments.x), to_half(moments.y)};
  std::memcpy(texel, both, sizeof both);
}

void store_texel(const Record& record, std::byte* texel, const std::array<float, 4>& values) {
  if (record.format == Format::E5B9G9R9_UFLOAT_PACK32) {
    const std::uint32_t bits = to_shared_exponent({values[0], values[1], values[2]});
    std::memcpy(texel, &bits, sizeof bits);
    return;
  }
  std::memset(texel, 0, record.bytes);
  for (std::size_t i = 0; i < record.count && i < values.size(); ++i) {
    const Component& component = record.components[i];
    const std::uint32_t most = tools::max_code(component);
    std::uint32_t code = 0;
    switch (component.type) {
      case ComponentType::unorm:
        code = static_cast<std::uint32_t>(
            std::floor(saturate(values[i]) * static_cast<float>(most) + 0.5F));
        break;
      case ComponentType::snorm: {
        const std::uint32_t positive = most / 2;
        const auto units = static_cast<float>(positive);
        const float rounded = std::floor(std::clamp(values[i], -1.0F, 1.0F) * units + 0.5F);
        code = static_cast<std::uint32_t>(static_cast<std::int32_t>(rounded)) & most;
        break;
      }
      case ComponentType::uint:
        code = std::min(static_cast<std::uint32_t>(values[i]), most);
        break;
      default:
        code = code_of(component, values[i]);
    }
    tools::store_component(texel, record.bytes, component, code);
  }
}

std::uint32_t encode_gamma5(float linear, std::uint32_t guess) {
  const auto& t = thresholds();
  if (linear >= t[guess] && (guess == 1023 || linear < t[guess + 1])) return guess;
  const auto end = std::upper_bound(t.begin() + 1, t.end(), linear);
  return static_cast<std::uint32_t>(end - t.begin()) - 1;
}

float decode_gamma5(std::uint32_t code) { return power5(static_cast<float>(code) / 1023.0F); }

float fifth_root(float linear) {
  if (linear > 1) return 2 * fifth_root(std::min(linear, std::numeric_limits<float>::max()) / 32);
  const std::uint32_t code = encode_gamma5(linear);
  if (code == 0) return 0;
  // Two steps of Newton's method from at most half a code away.
  double y = static_cast<double>(code) / 1023.0;
  for (int i = 0; i < 2; ++i) {
    const double y4 = y * y * y * y;
    y -= (y4 * y - static_cast<double>(linear)) / (5 * y4);
  }
  return saturate(static_cast<float>(y));
}

std::uint32_t to_ufloat(float value, unsigned bits) {
  const unsigned mantissa = bits - 5;
  const std::uint32_t most = (31U << mantissa) - 1;
  if (!(value > 0)) return 0;
  const int exponent = std::max(std::ilogb(value), -14);
  if (exponent > 15) return most;
  // In units of the last place; a carry out of the mantissa goes into the exponent.
  const auto units = static_cast<std::uint32_t>(
      std::lrint(value * power_of_two(static_cast<int>(mantissa) - exponent)));
  return std::min(most, (static_cast<std::uint32_t>(exponent + 14) << mantissa) + units);
}

float from_ufloat(std::uint32_t code, unsigned bits) {
  return from_half(static_cast<std::uint16_t>(code << (15 - bits)));
}

std::uint32_t to_shared_exponent(Vec3 value) {
  const auto bounded = [](float v) { return v > 0 ? std::min(v, 65408.0F) : 0.0F; };
  const float channels[3] = {bounded(value.x), bounded(value.y), bounded(value.z)};
  const float largest = std::max({channels[0], channels[1], channels[2]});
  int exponent = std::max(-16, largest > 0 ? std::ilogb(largest) : -16) + 16;
  const auto mantissa = [&](float v) {
    return static_cast<std::uint32_t>(std::floor(v * power_of_two(24 - exponent) + 0.5F));
  };
  if (mantissa(largest) == 512) ++exponent;
  return mantissa(channels[0]) | mantissa(channels[1]) << 9 | mantissa(channels[2]) << 18 |
         static_cast<std::uint32_t>(exponent) << 27;
}

Vec3 from_shared_exponent(std::uint32_t texel) {
  const float scale = power_of_two(static_cast<int>(texel >> 27) - 24);
  const auto channel = [&](unsigned shift) {
    return static_cast<float>(texel >> shift & 511U) * scale;
  };
  return {channel(0), channel(9), channel(18)};
}

std::uint16_t to_half(float value) {
  return Imath::half(std::clamp(value, -65504.0F, 65504.0F)).bits();
}

float from_half(std::uint16_t bits) {
  Imath::half half;
  half.setBits(bits);
  return half;
}

}  // namespace gicodec::ddgi
