// A grid of irradiance vectors as it is looked up (Pacanowski et al. §3.2).
#pragma once

#include "hemispheres.h"

#include <gicodec/volume.h>

#include <cstdint>
#include <vector>

namespace gicodec::vectors {

/// By hemisphere.
using Vertex = std::array<Vectors, kHemispheres>;

enum class Interpolation : std::uint8_t {
  trilinear,
  tricubic,  ///< B-spline (Sigg and Hadwiger, GPU Gems 2, 20)
};

struct VectorField {
  VolumeGeometry geometry;
  std::vector<Vertex> vertices;     ///< of the grid, by index
  std::vector<std::uint8_t> known;  ///< by index: others have no value, and no weight

  explicit VectorField(const VolumeGeometry& geometry_in)
      : geometry(geometry_in),
        vertices(std::size_t{geometry.grid.x} * geometry.grid.y * geometry.grid.z),
        known(vertices.size()) {}

  /// Irradiance over π at a place with a unit normal: of three hemispheres, by the normal's signs,
  /// with the squares of its coordinates. Outside the grid that of its nearest place; zero where
  /// nothing around is known. Between the axes even light is darker than along them, by down to
  /// 0.58. The geometry has not scrolled.
  [[nodiscard]] Vec3 irradiance(Vec3 position, Vec3 normal, Interpolation interpolation) const;
};

}  // namespace gicodec::vectors
