// Texels of the formats in which engines keep probes: values in, bits out, and back.
#pragma once

#include "vec.h"

#include <gicodec/record.h>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gicodec::ddgi {

/// How colour stands in its texture.
enum class Encoding : std::uint8_t {
  gamma5,  ///< the fifth root, as RTXGI keeps it in every format
  linear,  ///< radiance, as other engines keep it where the format is one of floats
};
[[nodiscard]] std::string_view to_string(Encoding encoding) noexcept;
[[nodiscard]] std::optional<Encoding> encoding_from_string(std::string_view name) noexcept;
/// gamma5 for unorm, linear for floats.
[[nodiscard]] Encoding usual_encoding(Format format) noexcept;

/// Formats of the two textures that can be traced and drawn; the first ones are the paper's.
[[nodiscard]] std::span<const Format> color_formats() noexcept;
[[nodiscard]] std::span<const Format> visibility_formats() noexcept;
/// "A2R10G10B10_UNORM_PACK32, R8G8B8A8_UNORM".
[[nodiscard]] std::string names_of(std::span<const Format> formats);

/// Colour in one of color_formats(). Bits of alpha: 0 for unorm, 1.0 for floats.
class ColorTexels {
 public:
  ColorTexels(Format format, Encoding encoding);

  /// The code of the value 1: 1023, 255, or 1 for floats.
  [[nodiscard]] float unit() const { return unit_; }
  [[nodiscard]] bool linear() const { return encoding_ == Encoding::linear; }
  /// What is stored, as codes for unorm.
  [[nodiscard]] Vec3 load(const std::byte* texel) const;
  /// Radiance as it is to be stored, before it is rounded to a texel: 0 to 1 for unorm.
  [[nodiscard]] Vec3 encode(Vec3 linear) const;
  /// The same, where no past is mixed in. `guess`, from load(), saves time and changes nothing.
  [[nodiscard]] Vec3 encode(Vec3 linear, Vec3 guess) const;
  /// Rounds to the nearest texel; what is too large becomes the largest finite one.
  void store(std::byte* texel, Vec3 encoded) const;

 private:
  Record record_;
  Encoding encoding_;
  float unit_ = 1;
};

/// Mean distance and mean squared distance in R16G16_SFLOAT or R32G32_SFLOAT.
[[nodiscard]] Vec2 load_moments(Format format, const std::byte* texel);
void store_moments(Format format, std::byte* texel, Vec2 moments);

/// A texel of any format of bytes or 16- or 32-bit words from the values of its components in
/// order; rounds to the nearest code, uint takes whole numbers.
void store_texel(const Record& record, std::byte* texel, const std::array<float, 4>& values);

/// Gamma 5: the 10-bit code of a linear value, nearest in the encoded domain, and back. A good
/// guess saves time; it does not change the answer.
[[nodiscard]] std::uint32_t encode_gamma5(float linear, std::uint32_t guess = 0);
[[nodiscard]] float decode_gamma5(std::uint32_t code);
/// The encoded value before it is rounded to a code. Precondition: linear >= 0.
[[nodiscard]] float fifth_root(float linear);

/// The nearest float of 10 or 11 bits without sign, ties to even; at most the largest finite one.
[[nodiscard]] std::uint32_t to_ufloat(float value, unsigned bits);
[[nodiscard]] float from_ufloat(std::uint32_t code, unsigned bits);
/// E5B9G9R9 as Vulkan defines the conversion.
[[nodiscard]] std::uint32_t to_shared_exponent(Vec3 value);
[[nodiscard]] Vec3 from_shared_exponent(std::uint32_t texel);
/// The nearest half, at most 65504.
[[nodiscard]] std::uint16_t to_half(float value);
[[nodiscard]] float from_half(std::uint16_t bits);

}  // namespace gicodec::ddgi
