// The server of AO points (Neff et al. §3.3): which points changed, and what is sent of them.
#pragma once

#include "occlusion.h"
#include "point_generation.h"
#include "point_memory.h"

#include "ddgi/parallel.h"
#include "ddgi/ray_scene.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gicodec::ao {

struct ServerOptions {
  GenerationOptions generation;
  std::uint32_t rays = 64;      ///< of a point
  float distance = 0.6F;        ///< metres
  std::uint32_t threshold = 4;  ///< of 255: changes of AO up to this are not sent
  bool rays_anew = false;       ///< others in each update
  double spare_cells = 0;       ///< share of cells more, for points that move within instances
};

/// What is updated: a cone around what a camera sees.
class ExtendedView {
 public:
  /// `margin`: degrees around the corners of the camera's picture.
  ExtendedView(const ddgi::Camera& camera, float aspect, float margin);
  [[nodiscard]] bool contains(ddgi::Vec3 place) const;

 private:
  ddgi::Vec3 eye_, forward_;
  float angle_, cosine_;
};

class PointServer {
 public:
  /// Points are generated, and have places in an order that codes well.
  PointServer(const ddgi::Scene& scene, const ServerOptions& options, ddgi::ThreadPool& pool);

  /// The points of an instance, to be moved within its space; the next update() looks where they
  /// are.
  [[nodiscard]] std::span<SurfacePoint> move(std::size_t instance);
  /// AO of the scene as it is, of points that any of the views contains; without views, and the
  /// first time, of all.
  void update(const ddgi::RayScene& scene, std::span<const ExtendedView> views = {});

  [[nodiscard]] const GeneratedPoints& generated() const { return generated_; }
  [[nodiscard]] const PointMemory& memory() const { return memory_; }
  [[nodiscard]] VolumeDesc volume() const;
  /// Textures of volume(), in order, as after the last update.
  [[nodiscard]] std::vector<std::vector<std::byte>> textures() const;

  struct Statistics {
    std::size_t traced = 0, changed = 0, unseen = 0;  ///< points, in the last update
  };
  [[nodiscard]] const Statistics& statistics() const { return statistics_; }

 private:
  static constexpr std::uint32_t kNowhere = ~0U;
  struct Point {
    std::uint32_t instance = 0, number = 0;  ///< of generated_
    std::uint32_t place = kNowhere;          ///< of memory_
    Grid cell{};
    std::uint8_t visible = 255;
    bool stale = true;   ///< something near moved since it was traced
    bool moved = false;  ///< within its instance since then
  };

  [[nodiscard]] const SurfacePoint& at(const Point& point) const {
    return generated_.instances[point.instance].points[point.number];
  }
  void put_all();
  void mark_stale(const ddgi::RayScene& scene);
  void follow(Point& point);

  ServerOptions options_;
  ddgi::ThreadPool& pool_;
  GeneratedPoints generated_;
  PointMemory memory_;
  Hemisphere hemisphere_;
  std::vector<Point> points_;
  std::vector<ddgi::Box> boxes_;          ///< of each instance in its own space
  std::vector<ddgi::Affine> transforms_;  ///< of each instance in the last update
  std::vector<std::uint8_t> moved_;       ///< instances whose points moved within them
  std::uint32_t updates_ = 0;
  Statistics statistics_;
};

}  // namespace gicodec::ao
