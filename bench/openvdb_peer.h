// OpenVDB as people keep voxels: a grid of three floats for each direction and level, as halves.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gicodec::bench {

struct OpenVdbVoxel {
  std::array<std::int32_t, 3> at{};
  std::array<std::array<float, 3>, 6> light{};
};

/// Bytes of a file of these voxels, by level, compressed by zip; 0 where this was built without
/// OpenVDB.
[[nodiscard]] std::size_t openvdb_zip(const std::vector<std::vector<OpenVdbVoxel>>& levels);

}  // namespace gicodec::bench
