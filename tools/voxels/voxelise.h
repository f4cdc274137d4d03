// Which voxels of a sparse grid the scene's triangles touch.
#pragma once

#include "ddgi/parallel.h"
#include "ddgi/scene.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::voxels {

using ddgi::Vec3;

/// Coordinates of a voxel within its level.
using Cell = std::array<std::uint32_t, 3>;
/// Their bits in turn, x lowest (Morton): that of the parent is this >> 3, that of the brick of n³
/// voxels this >> 3·log2(n).
using VoxelKey = std::uint64_t;

inline constexpr std::uint32_t kMostCells = 1U << 20;  ///< along an axis

/// Precondition: each below 2^21.
[[nodiscard]] VoxelKey voxel_key(const Cell& cell);
[[nodiscard]] Cell voxel_cell(VoxelKey key);

/// Where voxels of level 0 are.
struct VoxelGrid {
  Vec3 origin;  ///< the first one's lowest corner
  float size = 1;
  Cell cells{1, 1, 1};

  /// That covers a box. Throws tools::Error of Exit::usage where it has too many voxels.
  VoxelGrid(const ddgi::Box& box, float size);
};

using Triangle = std::array<Vec3, 3>;

/// Whether they have a point in common, by the 13 axes that may separate them (Akenine-Möller).
[[nodiscard]] bool overlaps(const Triangle& triangle, const std::array<double, 3>& centre,
                            double half);

/// The scene must outlive it.
class Voxeliser {
 public:
  /// Throws tools::Error of Exit::usage where surfaces would take too many voxels.
  Voxeliser(const ddgi::Scene& scene, const VoxelGrid& grid, ddgi::ThreadPool& pool);

  /// Voxels of all surfaces, ascending. What never moves was looked at once.
  [[nodiscard]] std::vector<VoxelKey> voxels(const ddgi::FrameState& state) const;

 private:
  void add_triangles(std::uint32_t object, const ddgi::Affine& transform,
                     std::vector<Triangle>& out) const;
  [[nodiscard]] std::vector<VoxelKey> touched(std::span<const Triangle> triangles) const;

  const ddgi::Scene& scene_;
  VoxelGrid grid_;
  ddgi::ThreadPool& pool_;
  std::vector<VoxelKey> still_;
};

}  // namespace gicodec::voxels
