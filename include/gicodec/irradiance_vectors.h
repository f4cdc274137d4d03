// Irradiance vectors (Pacanowski et al. §3), each a colour and a direction. Each vertex of a grid
// has six, for the hemispheres around +x, −x, +y, −y, +z, −z.
#pragma once

#include <gicodec/api.h>
#include <gicodec/kind.h>
#include <gicodec/texture.h>

#include <cstdint>

namespace GICODEC_API gicodec {

inline constexpr std::uint8_t kKindIrradianceVectors = 2;

/// Kind 2: one group of one texture, "vectors", a block of 6×1×1 records per vertex. The sum of
/// direction · (R + G + B) over two opposite hemispheres should be the same for all three axes, as
/// it is if all are integrated from the same rays; native uses this. A vertex of zeros has no
/// light, e.g. within a wall; the renderer interpolates it from its neighbours.
extern const Kind kIrradianceVectors;

/// A volume of this kind, with records colored_direction(floats): quantised as in §3.3, or floats.
/// Tiling::blocks. invalid_description if the grid is out of range.
[[nodiscard]] Result<VolumeDesc> irradiance_vector_volume(Grid grid, bool floats = false);

}  // namespace gicodec
