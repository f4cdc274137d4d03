// Where the points of a scene are (Neff et al. §3.1): on each mesh of each object, in the object's
// own space.
#pragma once

#include "sample_elimination.h"

#include "ddgi/scene.h"

#include <gicodec/ao_points.h>

#include <cstdint>
#include <string>
#include <vector>

namespace gicodec::ao {

struct GenerationOptions {
  double points = 512;               ///< generated per square metre of a side; half of them stay
  std::size_t max_points = 1000000;  ///< that stay; fewer are generated where it would be more
  /// Also on what stands still outside of the scene's volume and a metre around it.
  bool outside = false;
  float margin = 0;  ///< metres around a mesh for points that move within it
  std::uint32_t seed = 1;
};

/// A mesh of an object. Positions are the mesh's own; radii and densities are those of the world,
/// an object's scale at rest undone.
struct PointInstance {
  std::uint32_t object = 0, mesh = 0;
  AoGrid grid;  ///< its buckets are those that it needs, from first_bucket 0 on
  std::vector<SurfacePoint> points;

  [[nodiscard]] ddgi::Box box() const;  ///< of the points
};

struct GeneratedPoints {
  std::vector<PointInstance> instances;  ///< in the order of objects, those that have area
  double points = 0;                     ///< generated per square metre
  std::vector<std::string> remarks;      ///< where that is less than was asked for
};

/// The same for the same scene and options, whatever the number of threads.
[[nodiscard]] GeneratedPoints generate_points(const ddgi::Scene& scene,
                                              const GenerationOptions& options,
                                              ddgi::ThreadPool& pool);

}  // namespace gicodec::ao
