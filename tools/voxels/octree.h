// Levels of voxels, each the means of the one below.
#pragma once

#include "voxel_code.h"
#include "voxelise.h"

#include <span>
#include <vector>

namespace gicodec::voxels {

struct OctreeLevel {
  std::vector<VoxelKey> keys;      ///< of voxels that exist, ascending
  std::vector<std::byte> records;  ///< their light as it is stored
};

/// The finest first.
using Octree = std::vector<OctreeLevel>;

/// So many that one brick holds all cells, or as many as there can be.
[[nodiscard]] unsigned levels_of(const Cell& cells, unsigned side);
/// Voxels of all levels from those of level 0, without light.
[[nodiscard]] Octree grow(std::vector<VoxelKey> leaves, unsigned levels);
/// Light of all levels from that of level 0.
void pull(Octree& octree, const VoxelCode& code);
/// The light of a voxel from that of those of its 2³ children that exist, by their numbers 0 to 7;
/// of each direction from those that are not zero.
[[nodiscard]] Voxel mean_of(std::span<const Voxel> children, std::span<const unsigned> numbers);

}  // namespace gicodec::voxels
