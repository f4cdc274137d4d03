// Light around a probe as spherical harmonics: what engines keep in place of octahedral texels. One
// texel per probe in each of several textures.
#pragma once

#include "vec.h"

#include <gicodec/texture.h>

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::ddgi {

struct ProbeRay;

enum class ShForm : std::uint8_t {
  none,
  /// sha_r, sha_g, sha_b in R16G16B16A16_SFLOAT: for each colour the factors of x, y, z and 1.
  l1,
  /// These, whose last one contains that of -z² (so that shaders multiply by z² alone), and shb_r,
  /// shb_g, shb_b with the factors of xy, yz, z², zx, and shc with R, G, B of x² - y², and 1.
  l2,
  /// As Unity's probe volumes: l0_l1rx in R16G16B16A16_SFLOAT with R, G, B of 1 and red's x,
  /// l1g_l1ry and l1b_l1rz in R8G8B8A8_UNORM with green's x, y, z and red's y, and blue's and red's
  /// z. Those of x, y and z are ratios to that of 1: factor / (4 · that of 1) + 1/2.
  l1_over_l0,
};
[[nodiscard]] std::string_view to_string(ShForm form) noexcept;

struct ShTexture {
  std::string name;
  TextureDesc desc;  ///< blocks of one texel
  std::vector<std::byte> texels;
  friend bool operator==(const ShTexture&, const ShTexture&) = default;
};
/// All zero.
[[nodiscard]] std::vector<ShTexture> sh_textures(ShForm form, Grid grid);

/// Irradiance over π in direction n is the sum of these times 1; x, y, z; xy, yz, 3z² - 1, zx,
/// x² - y² of n.
using ShFactors = std::array<Vec3, 9>;
/// Projects what rays bring; those that see insides do not count.
[[nodiscard]] ShFactors project_sh(std::span<const Vec3> directions,
                                   std::span<const ProbeRay> rays);
/// Mixes them into a probe's texels, in the texels' own precision.
void store_sh(ShForm form, const ShFactors& factors, float hysteresis, std::uint32_t probe,
              std::vector<ShTexture>& textures);

}  // namespace gicodec::ddgi
