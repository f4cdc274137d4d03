// The order in which a client gets vertices of irradiance vectors (Pacanowski et al. §4.1).
#pragma once

#include <gicodec/texture.h>

#include <cstdint>
#include <vector>

namespace gicodec {

/// The place of each vertex: the corners of the grid first, then rounds of one random vertex per
/// slice of the longest axis. Depends only on the grid. Throws std::bad_alloc.
[[nodiscard]] std::vector<std::uint32_t> stratified_order(const Grid& grid);

}  // namespace gicodec
