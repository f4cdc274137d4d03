// The texels around one (docs/native/continuous.md, "Neighbours").
#pragma once

#include "native/raster/raster.h"

#include <cstddef>
#include <cstdint>

namespace gicodec::native {

/// Texels of a raster, all before `here`. What lies beyond an edge is replaced by the nearest;
/// texel 0, if there is none.
struct Place {
  std::size_t here;
  std::size_t w, n, nw, ne, ww, nn;
  std::size_t z, zw, zn;  ///< in the slice before; of the first slice not to be used
  bool deep;              ///< there is a slice before
};

inline Place place_of(const Raster& raster, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  const std::size_t row = raster.size().x, slice = row * raster.size().y;
  Place p{};
  p.here = 1 + x + row * y + slice * z;
  p.deep = z > 0;
  if (p.deep) {
    p.z = p.here - slice;
    p.zw = x > 0 ? p.z - 1 : p.z;
    p.zn = y > 0 ? p.z - row : p.z;
  }
  p.w = x > 0 ? p.here - 1 : y > 0 ? p.here - row : p.z;
  p.n = y > 0 ? p.here - row : p.w;
  p.nw = x > 0 && y > 0 ? p.here - row - 1 : p.n;
  p.ne = x + 1 < row && y > 0 ? p.here - row + 1 : p.n;
  p.ww = x > 1 ? p.here - 2 : p.w;
  p.nn = y > 1 ? p.here - 2 * row : p.n;
  return p;
}

}  // namespace gicodec::native
