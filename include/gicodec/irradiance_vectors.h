// Irradiance vectors (Pacanowski et al. §3): at each vertex of a grid six of them, over the
// hemispheres +x, −x, +y, −y, +z, −z, each a direction and a colour.
#pragma once

#include <gicodec/api.h>
#include <gicodec/kind.h>
#include <gicodec/texture.h>

#include <cstdint>

namespace GICODEC_API gicodec {

inline constexpr std::uint8_t kKindIrradianceVectors = 2;

/// Kind 2: one set of two textures, "direction" and "color", blocks of 6×1×1, which travel
/// together.
extern const Kind kIrradianceVectors;

/// Quantised as in §3.3: R8G8B8_SNORM and E5B9G9R9_UFLOAT_PACK32; or, with `floats`, both as
/// R32G32B32_SFLOAT. In memory each texture is an array of blocks.
[[nodiscard]] Result<VolumeDesc> irradiance_vector_volume(Grid grid, bool floats = false);

}  // namespace gicodec
