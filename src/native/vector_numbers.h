// Arithmetic of the vector model (docs/native.md, "Vectors"): directions and colours of both forms
// as whole numbers.
#pragma once

#include "native/record_numbers.h"

#include <gicodec/texture.h>

#include <array>
#include <cstddef>

namespace gicodec::native {

inline constexpr std::size_t kHemispheres = 6;
inline constexpr std::int64_t kUnitLength = 1 << 24;
inline constexpr std::int64_t kMostDirection = 2 * kUnitLength;
inline constexpr std::int64_t kMostColor = std::int64_t{1} << 41;

using Direction = std::array<std::int64_t, 3>;  ///< in units of 1 / kUnitLength
using Color = std::array<std::int64_t, 3>;      ///< 0 to kMostColor, in units of the vertex

/// Light of one hemisphere.
struct HemisphereLight {
  Direction direction{};
  Color color{};
  [[nodiscard]] std::int64_t sum() const { return color[0] + color[1] + color[2]; }
};

/// A record's components as codes that are ordered like their values.
struct VectorCodes {
  std::array<std::int32_t, 3> color{};
  std::int32_t exponent = 0;  ///< quantised
  std::array<std::int32_t, 3> direction{};
  friend bool operator==(const VectorCodes&, const VectorCodes&) = default;
};

/// The two forms of colored_direction().
class VectorForm {
 public:
  explicit VectorForm(const Record& record) : floats_(record.bytes == kFloatBytes) {}
  [[nodiscard]] bool floats() const { return floats_; }
  [[nodiscard]] std::size_t bytes() const { return floats_ ? kFloatBytes : kQuantisedBytes; }
  [[nodiscard]] unsigned color_bits() const { return floats_ ? 32 : 9; }
  [[nodiscard]] unsigned direction_bits() const { return floats_ ? 32 : 8; }

  [[nodiscard]] VectorCodes read(const std::byte* record) const;
  void write(const VectorCodes& codes, std::byte* record) const;

  /// The exponent of the brightest colour; 0 without light.
  [[nodiscard]] int top(const VectorCodes& codes) const;
  /// With colours in units of a vertex whose top is that.
  [[nodiscard]] HemisphereLight light(const VectorCodes& codes, int top) const;
  [[nodiscard]] std::int64_t direction_of(std::int32_t code) const;
  [[nodiscard]] std::int64_t color_of(std::int32_t code, int exponent, int top) const;

  /// The code next to a direction's coordinate, and the quarter of a step that it is in.
  struct Predicted {
    std::int32_t code = 0;
    std::uint32_t quarter = 0;
  };
  [[nodiscard]] Predicted direction_code(std::int64_t coordinate) const;
  /// The code next to a colour: of a mantissa with that exponent, or of a float.
  [[nodiscard]] std::int32_t color_code(std::int64_t color, int exponent, int top) const;
  /// Quantised: the exponent that a colour's brightest component has.
  [[nodiscard]] int exponent_of(std::int64_t brightest, int top) const;

 private:
  static constexpr std::size_t kQuantisedBytes = 7, kFloatBytes = 24;
  bool floats_;
};

/// The whole root.
[[nodiscard]] std::int64_t root_of(std::int64_t value);
/// A vector of any length to unit length; `axis` where it has none. Coordinate `along` is 0 if its
/// sign is not that of `axis`. `length`: what it had.
[[nodiscard]] Direction normalised(Direction v, std::size_t along, bool negative,
                                   std::int64_t& length);

/// value · 2^−shift to the nearest, at most 2^40.
[[nodiscard]] inline std::int64_t in_steps(std::int64_t value, int shift) {
  constexpr int kMostBits = 40;
  if (shift > 0) return shift > 62 ? 0 : (value + (std::int64_t{1} << (shift - 1))) >> shift;
  const int bits = static_cast<int>(width_of(value)) - shift;
  return bits > kMostBits ? std::int64_t{1} << kMostBits : value << -shift;
}

}  // namespace gicodec::native
