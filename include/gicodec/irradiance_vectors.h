// Irradiance vectors (Pacanowski et al. §3): at each vertex of a grid six of them, over the
// hemispheres around +x, −x, +y, −y, +z, −z, each a colour and a direction.
#pragma once

#include <gicodec/api.h>
#include <gicodec/kind.h>
#include <gicodec/texture.h>

#include <cstdint>

namespace GICODEC_API gicodec {

inline constexpr std::uint8_t kKindIrradianceVectors = 2;

/// Kind 2: one set of one texture, "vectors": a block of 6×1×1 records at each vertex. Opposite
/// hemispheres sum up to the same, direction · (R + G + B) each, as what is integrated from the
/// same rays does (native makes use of it). A vertex all of whose bytes are zero has no light to
/// tell, as within a wall: whoever draws fills it in from those around.
extern const Kind kIrradianceVectors;

/// Records are colored_direction(): quantised as in §3.3, or floats. In memory the texture is an
/// array of blocks.
[[nodiscard]] Result<VolumeDesc> irradiance_vector_volume(Grid grid, bool floats = false);

}  // namespace gicodec
