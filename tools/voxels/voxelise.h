// Which voxels of a sparse grid the scene's triangles touch, and where these look.
#pragma once

#include "ddgi/parallel.h"
#include "ddgi/scene.h"

#include <gicodec/voxels.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::voxels {

using ddgi::Vec3;

/// Coordinates of a voxel within its level.
using Cell = std::array<std::uint32_t, 3>;
/// Its Morton key: that of the parent is this >> 3, that of the brick of n³ voxels this >>
/// 3·log2(n).
using VoxelKey = std::uint64_t;

inline constexpr std::uint32_t kMaxCells = 1U << 20;  ///< along an axis

/// Where voxels of level 0 are.
struct VoxelGrid {
  Vec3 origin;  ///< the first one's lowest corner
  float size = 1;
  Cell cells{1, 1, 1};

  /// That covers a box. Throws tools::Error of Exit::usage where it has too many voxels.
  VoxelGrid(const ddgi::Box& box, float size);
};

using Triangle = std::array<Vec3, 3>;

/// A bit for each of the six directions of a voxel.
using Directions = std::uint8_t;
inline constexpr Directions kAllDirections = (1U << kVoxelDirections) - 1;

/// A voxel with surfaces in it.
struct SurfaceVoxel {
  VoxelKey key = 0;
  Directions faced = 0;  ///< that a normal there points to, by more than a hundredth of its share
  auto operator<=>(const SurfaceVoxel&) const = default;
};

/// Whether they have a point in common, by the 13 axes that may separate them (Akenine-Möller).
[[nodiscard]] bool overlaps(const Triangle& triangle, const std::array<double, 3>& centre,
                            double half);

/// The scene must outlive it.
class Voxeliser {
 public:
  /// Throws tools::Error of Exit::usage where surfaces would take too many voxels.
  Voxeliser(const ddgi::Scene& scene, const VoxelGrid& grid, ddgi::ThreadPool& pool);

  /// Voxels of all surfaces, ascending. What never moves was looked at once.
  [[nodiscard]] std::vector<SurfaceVoxel> voxels(const ddgi::FrameState& state) const;

 private:
  struct Facet {
    Triangle corners;
    Directions faced;
  };

  void add_facets(std::uint32_t object, const ddgi::Affine& transform,
                  std::vector<Facet>& out) const;
  [[nodiscard]] std::vector<SurfaceVoxel> touched(std::span<const Facet> facets) const;

  const ddgi::Scene& scene_;
  VoxelGrid grid_;
  ddgi::ThreadPool& pool_;
  std::vector<SurfaceVoxel> still_;
};

}  // namespace gicodec::voxels
