// Light around a probe as six irradiance vectors (<gicodec/irradiance_vectors.h>).
#pragma once

#include "vec.h"

#include <gicodec/kind.h>

#include <span>
#include <string_view>
#include <vector>

namespace gicodec::ddgi {

struct ProbeRay;

enum class VectorForm : std::uint8_t { none, quantised, floats };
[[nodiscard]] std::string_view to_string(VectorForm form) noexcept;

/// The vector over a hemisphere, divided by π, is direction · color for each colour: the direction
/// is that of the sum of the three colours' vectors, the color their length along it.
struct VectorTextures {
  VolumeDesc volume;  ///< without sets: there are none
  std::vector<std::byte> direction, color;
  friend bool operator==(const VectorTextures&, const VectorTextures&) = default;
};
/// All zero. Precondition: the grid is valid.
[[nodiscard]] VectorTextures vector_textures(VectorForm form, Grid grid);

/// Integrates what rays bring, except from insides, and mixes it into a probe's block, in the
/// textures' own precision.
void store_vectors(std::span<const Vec3> directions, std::span<const ProbeRay> rays,
                   float hysteresis, std::uint32_t probe, VectorTextures& textures);

}  // namespace gicodec::ddgi
