// In which order vertices of irradiance vectors come to a client (Pacanowski et al. §4.1).
#pragma once

#include <gicodec/texture.h>

#include <cstdint>
#include <vector>

namespace gicodec {

/// By vertex its place: the corners of the grid first, then one vertex at random of each slice
/// along the longest axis, and again. Depends on nothing but the grid. Throws std::bad_alloc.
[[nodiscard]] std::vector<std::uint32_t> stratified_order(const Grid& grid);

}  // namespace gicodec
