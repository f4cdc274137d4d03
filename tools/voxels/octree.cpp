#include "octree.h"

#include <algorithm>

namespace gicodec::voxels {

unsigned levels_of(const Cell& cells, unsigned side) {
  const std::uint64_t most = *std::ranges::max_element(cells);
  unsigned level = 0;
  while (level < kMaxBrickLevel && std::uint64_t{side} << level < most) ++level;
  return level + 1;
}

Octree grow(std::vector<VoxelKey> leaves, unsigned levels) {
  Octree octree(levels);
  octree[0].keys = std::move(leaves);
  for (unsigned level = 1; level < levels; ++level) {
    std::vector<VoxelKey>& keys = octree[level].keys;
    for (const VoxelKey child : octree[level - 1].keys) {
      if (keys.empty() || keys.back() != child >> 3) keys.push_back(child >> 3);
    }
  }
  return octree;
}

Voxel mean_of(std::span<const Voxel> children, std::span<const unsigned> numbers) {
  Voxel mean;
  for (std::size_t d = 0; d < kVoxelDirections; ++d) {
    const auto axis = static_cast<unsigned>(d / 2);
    std::array<float, 8> open{1, 1, 1, 1, 1, 1, 1, 1};  // by column along the axis
    unsigned lit = 0;                                   // buried voxels do not count
    for (std::size_t i = 0; i < children.size(); ++i) {
      lit += children[i].color[d] == Vec3{} ? 0 : 1;
      mean.color[d] += children[i].color[d];
      open[numbers[i] & ~(1U << axis)] *= 1 - children[i].cover[d];
    }
    if (lit != 0) mean.color[d] *= 1 / static_cast<float>(lit);
    for (unsigned column = 0; column < 8; ++column) {
      if ((column >> axis & 1) == 0) mean.cover[d] += (1 - open[column]) / 4;
    }
  }
  return mean;
}

void pull(Octree& octree, const VoxelCode& code) {
  std::vector<Voxel> children;
  std::vector<unsigned> numbers;
  for (std::size_t level = 1; level < octree.size(); ++level) {
    const OctreeLevel& fine = octree[level - 1];
    OctreeLevel& coarse = octree[level];
    coarse.records.resize(coarse.keys.size() * code.bytes());
    std::size_t child = 0;
    for (std::size_t i = 0; i < coarse.keys.size(); ++i) {
      children.clear(), numbers.clear();
      for (; child < fine.keys.size() && fine.keys[child] >> 3 == coarse.keys[i]; ++child) {
        children.push_back(code.load(&fine.records[child * code.bytes()]));
        numbers.push_back(static_cast<unsigned>(fine.keys[child] & 7));
      }
      code.store(&coarse.records[i * code.bytes()], mean_of(children, numbers));
    }
  }
}

}  // namespace gicodec::voxels
