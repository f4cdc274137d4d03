// Triangles of a scene cut into charts: pieces of surface that are nearly plane.
#pragma once

#include "ddgi/scene.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gicodec::maps {

using ddgi::Vec2;
using ddgi::Vec3;

/// A mesh of an object; triangles count through the instances.
struct Instance {
  std::uint32_t object = 0, mesh = 0;
  std::uint32_t first = 0, triangles = 0;
};

struct Chart {
  Vec3 normal, u, v;  ///< of its plane, at rest
  Vec2 least, size;   ///< metres along u and v
  float density = 1;  ///< beside that of other charts
  std::vector<std::uint32_t> triangles;
};

struct SceneCharts {
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  std::vector<Instance> instances;  ///< by object, in the order of its meshes
  std::vector<Chart> charts;
  std::vector<std::uint32_t> chart_of;         ///< by triangle; kNone without an area
  std::vector<std::array<Vec3, 3>> positions;  ///< by triangle, at rest
};

/// Triangles that share an edge and look into like directions make a chart. Depends on nothing but
/// the scene at rest.
[[nodiscard]] SceneCharts make_charts(const ddgi::Scene& scene);

}  // namespace gicodec::maps
