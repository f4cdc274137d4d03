// Arithmetic of the light model (docs/native/light.md): directions and colours of
// all encodings as whole numbers.
#pragma once

#include "native/models/numbers.h"

#include <gicodec/texture.h>

#include <array>
#include <cstddef>

namespace gicodec::native {

inline constexpr std::size_t kHemispheres = 6;
inline constexpr std::int64_t kUnitLength = 1 << 24;
inline constexpr std::int64_t kMaxDirection = 2 * kUnitLength;
inline constexpr std::int64_t kMaxColor = std::int64_t{1} << 41;

using Direction = std::array<std::int64_t, 3>;  ///< in units of 1 / kUnitLength
using Color = std::array<std::int64_t, 3>;      ///< 0 to kMaxColor, in units of the vertex

/// Light over one hemisphere.
struct HemisphereLight {
  Direction direction{};
  Color color{};
  [[nodiscard]] std::int64_t sum() const { return color[0] + color[1] + color[2]; }
};

/// A record's components as codes that are ordered like their values.
struct LightCodes {
  std::array<std::int32_t, 3> color{};
  std::int32_t exponent = 0;  ///< that they share
  std::int32_t alpha = 0;
  std::array<std::int32_t, 3> direction{};
  friend bool operator==(const LightCodes&, const LightCodes&) = default;
};

/// Records of light: both of colored_direction(), E5B9G9R9_UFLOAT_PACK32 and
/// R16G16B16A16_SFLOAT.
class LightEncoding {
 public:
  /// Precondition: it is one of these.
  explicit LightEncoding(const Record& record);
  [[nodiscard]] bool shared() const { return shared_; }      ///< colours have one exponent
  [[nodiscard]] bool directed() const { return directed_; }  ///< with a direction
  [[nodiscard]] bool alpha() const { return !shared_ && !directed_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] unsigned color_bits() const { return color_bits_; }
  [[nodiscard]] unsigned direction_bits() const { return shared_ ? 8 : 32; }

  [[nodiscard]] LightCodes read(const std::byte* record) const;
  /// Which of a voxel's six records have colours, or an exponent, that are not zero, by bit.
  [[nodiscard]] std::uint8_t lit(const std::byte* records) const;
  void write(const LightCodes& codes, std::byte* record) const;

  /// The exponent of the brightest colour; 0 without light.
  [[nodiscard]] int top(const LightCodes& codes) const;
  /// What to take for it where nothing has light.
  [[nodiscard]] int default_top() const;
  /// With colours in units of a vertex whose top is that.
  [[nodiscard]] HemisphereLight light(const LightCodes& codes, int top) const;
  [[nodiscard]] std::int64_t direction_of(std::int32_t code) const;
  [[nodiscard]] std::int64_t color_of(std::int32_t code, int exponent, int top) const;
  /// From green to what its next code stands for.
  [[nodiscard]] std::int64_t color_step(const LightCodes& codes, int top) const {
    const std::int32_t green = shared_ ? 0 : codes.color[1];
    return color_of(green + 1, codes.exponent, top) - color_of(green, codes.exponent, top);
  }

  /// The code next to a direction's coordinate, and the quarter of a step that it is in.
  struct Predicted {
    std::int32_t code = 0;
    std::uint32_t quarter = 0;
  };
  [[nodiscard]] Predicted direction_code(std::int64_t coordinate) const;
  /// A colour's code, of the bits that it has room for.
  [[nodiscard]] std::int32_t color_of_bits(std::int64_t code) const;
  /// The code next to a colour: of a mantissa with that exponent, or of a float.
  [[nodiscard]] std::int32_t color_code(std::int64_t color, int exponent, int top) const;
  /// The exponent that they share, by the brightest.
  [[nodiscard]] int exponent_of(std::int64_t brightest, int top) const;

 private:
  std::size_t bytes_ = 0;
  bool shared_ = false, directed_ = false;
  unsigned color_bits_ = 0;
  unsigned fraction_ = 0;  ///< bits of a float's
};

/// The whole root.
[[nodiscard]] std::int64_t root_of(std::int64_t value);
/// A vector of any length to unit length; `axis` where it has none. Coordinate `along` is 0 if its
/// sign is not that of `axis`. `length`: what it had.
[[nodiscard]] Direction normalised(Direction v, std::size_t along, bool negative,
                                   std::int64_t& length);

/// value · 2^−shift to the nearest, at most 2^40.
[[nodiscard]] inline std::int64_t in_steps(std::int64_t value, int shift) {
  constexpr int kMaxBits = 40;
  if (shift > 0) return shift > 62 ? 0 : (value + (std::int64_t{1} << (shift - 1))) >> shift;
  const int bits = static_cast<int>(width_of(value)) - shift;
  return bits > kMaxBits ? std::int64_t{1} << kMaxBits : value << -shift;
}

}  // namespace gicodec::native
