// The probe volume's place in the world and the two textures that hold it.
#pragma once

#include "vec.h"

#include <gicodec/texture.h>

#include <span>
#include <vector>

namespace gicodec::ddgi {

inline constexpr std::uint32_t kIrradianceCore = 8;
inline constexpr std::uint32_t kVisibilityCore = 16;
inline constexpr std::uint32_t kIrradianceSide = kIrradianceCore + 2;
inline constexpr std::uint32_t kVisibilitySide = kVisibilityCore + 2;

/// Probe (x, y, z) stands at origin + (x, y, z) · spacing; its index is x + nx·(y + ny·z).
struct VolumeShape {
  Grid grid;
  Vec3 origin, spacing;

  [[nodiscard]] std::uint32_t probes() const { return grid.x * grid.y * grid.z; }
  [[nodiscard]] Vec3 position(std::uint32_t probe) const;
  /// Distances beyond this are stored as this: 1.5 × the diagonal of a cell.
  [[nodiscard]] float distance_cap() const { return 1.5F * length(spacing); }
};

/// The grid spread over a box, first and last probes on its faces.
[[nodiscard]] VolumeShape spread(Grid grid, const Box& box);

/// The colour texture holds gamma-5 encoded irradiance over π in R, G, B and 0 in A; visibility
/// holds mean distance and mean squared distance in metres. Blocks of inactive probes are zero.
struct ProbeTextures {
  TextureDesc color_desc, visibility_desc;
  std::vector<std::uint32_t> color, visibility;  ///< texels, tightly packed

  /// All zero. Precondition: the descriptions are ddgi_irradiance() and ddgi_visibility() of one
  /// grid.
  ProbeTextures() = default;
  explicit ProbeTextures(Grid grid);

  friend bool operator==(const ProbeTextures&, const ProbeTextures&) = default;
};

/// Whether a texture can be one of the two, by format and block.
[[nodiscard]] bool is_color(const TextureDesc& desc);
[[nodiscard]] bool is_visibility(const TextureDesc& desc);

/// Copies the block of a probe out of a texture or into it; `block` has side² texels.
void read_block(const TextureDesc& desc, std::span<const std::uint32_t> texture,
                std::uint32_t probe, std::span<std::uint32_t> block);
void write_block(const TextureDesc& desc, std::span<std::uint32_t> texture, std::uint32_t probe,
                 std::span<const std::uint32_t> block);
/// Fills the guard band of a block from its core texels by the octahedral rule.
void fill_guard_band(std::span<std::uint32_t> block, std::uint32_t side);

/// Gamma 5: the 10-bit code of a linear value, nearest in the encoded domain, and back. A good
/// guess saves time; it does not change the answer.
[[nodiscard]] std::uint32_t encode_gamma5(float linear, std::uint32_t guess = 0);
[[nodiscard]] float decode_gamma5(std::uint32_t code);
/// The encoded value in [0, 1] before rounding to a code.
[[nodiscard]] float fifth_root(float linear);
[[nodiscard]] constexpr std::uint32_t pack_color(std::uint32_t r, std::uint32_t g,
                                                 std::uint32_t b) {
  return r << 20 | g << 10 | b;
}
[[nodiscard]] std::uint32_t pack_moments(float mean, float mean_squared);
[[nodiscard]] Vec2 unpack_moments(std::uint32_t texel);

}  // namespace gicodec::ddgi
