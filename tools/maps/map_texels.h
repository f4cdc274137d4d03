// Irradiance maps as textures of their kind: texels, coverage, coefficients, hash.
#pragma once

#include "clusters.h"

#include "ddgi/texels.h"

#include <gicodec/irradiance_maps.h>

#include <cstddef>
#include <span>
#include <vector>

namespace gicodec::maps {

/// Irradiance over π in a format: floats as they are, of unorm the fifth root.
class TexelCode {
 public:
  explicit TexelCode(Format format);
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  void store(std::byte* texel, Vec3 value) const { texels_.store(texel, texels_.encode(value)); }
  /// How many of these are brighter than it holds.
  [[nodiscard]] std::size_t clips(std::span<const Vec3> values) const;
  /// Of any bits: finite and not negative.
  [[nodiscard]] Vec3 load(const std::byte* texel) const;

 private:
  ddgi::ColorTexels texels_;
  std::size_t bytes_;
};

/// A bit for each of the texels, tile by tile; and the other way round, a byte by place.
[[nodiscard]] std::vector<std::byte> coverage_of(const Parameterisation& map,
                                                 std::span<const MapTexel> texels);
[[nodiscard]] std::vector<std::uint8_t> existence_of(const Parameterisation& map,
                                                     std::span<const std::byte> coverage);
/// Texels of a map by place, zero where nothing is.
[[nodiscard]] std::vector<std::byte> texels_of(const Parameterisation& map,
                                               std::span<const MapTexel> texels,
                                               const TexelCode& code, std::span<const Vec3> values);
/// Of the pool: whole blocks.
[[nodiscard]] std::vector<std::byte> coefficients_of(const TexelCode& code,
                                                     std::span<const Vec3> bases);
[[nodiscard]] std::vector<std::byte> blends_of(const Parameterisation& map,
                                               std::span<const MapTexel> texels,
                                               std::span<const Blend> blends);
[[nodiscard]] std::vector<std::byte> hash_of(const Parameterisation& map);

}  // namespace gicodec::maps
