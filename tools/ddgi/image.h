// Texture images: 8-bit sRGB with a mip pyramid, sampled to linear colour.
#pragma once

#include "vec.h"

#include <array>
#include <functional>
#include <vector>

namespace gicodec::ddgi {

/// The sRGB code of a linear value.
[[nodiscard]] std::uint8_t linear_to_srgb(float value);

/// Repeats in both directions. Immutable after construction.
class Image {
 public:
  struct Level {
    std::uint32_t width = 0, height = 0;
    std::vector<std::array<std::uint8_t, 3>> texels;  ///< sRGB, row by row
  };

  Image() = default;
  /// Precondition: texels.size() == width · height > 0.
  Image(std::uint32_t width, std::uint32_t height, std::vector<std::array<std::uint8_t, 3>> texels);

  [[nodiscard]] const Level& base() const { return levels_.front(); }
  /// Bilinear fetch; `footprint` is the sampled width in units of uv and selects the level.
  [[nodiscard]] Vec3 sample(Vec2 uv, float footprint) const;

 private:
  std::vector<Level> levels_;
};

/// A square image of side `side` from a function of (u, v) in [0, 1)² to linear colour.
[[nodiscard]] Image make_image(std::uint32_t side, const std::function<Vec3(float, float)>& colour);

}  // namespace gicodec::ddgi
