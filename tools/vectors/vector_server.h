// The server of irradiance vectors: gathers light at every vertex of a grid (Pacanowski et al. §3).
#pragma once

#include "vector_field.h"

#include "ddgi/gather.h"
#include "ddgi/parallel.h"

#include <functional>

namespace gicodec::vectors {

struct VectorOptions {
  Grid grid{16, 16, 16};
  bool floats = false;
  ddgi::GatherOptions gather;  ///< of vertices, over the whole sphere
  ddgi::Box box;               ///< from the first vertex to the last
};

class VectorServer {
 public:
  /// Throws tools::Error. The scene must outlive it.
  VectorServer(const ddgi::Scene& scene, const VectorOptions& options, unsigned threads,
               std::function<bool()> cancelled);

  /// Gathers one update of the scene at `time`: one bounce more of indirect light.
  void update(double time);
  [[nodiscard]] const VectorOptions& options() const { return options_; }
  /// Before it is compressed. A vertex within a solid is not known.
  [[nodiscard]] const VectorField& field() const { return field_; }
  [[nodiscard]] std::uint64_t rays() const { return rays_; }  ///< of the last update
  /// The texture of the volume: zero where a vertex is not known.
  [[nodiscard]] std::vector<std::byte> texels() const;

 private:
  void step(double time);
  /// False within a solid.
  bool gather(std::uint32_t vertex, std::span<const Vec3> directions, Vertex& out,
              std::uint64_t& rays) const;

  VectorOptions options_;
  ddgi::RayScene scene_;
  ddgi::ThreadPool pool_;
  std::vector<Vec3> directions_;
  VectorField field_;
  std::uint64_t rays_ = 0;
  std::uint32_t updates_ = 0;
};

[[nodiscard]] VolumeGeometry geometry_of(const ddgi::Box& box, Grid grid);

}  // namespace gicodec::vectors
