// Indirect light as a client has it, ready to be drawn with: one implementation for each kind.
#pragma once

#include "parallel.h"
#include "ray_scene.h"

#include <cstdint>

namespace gicodec::ddgi {

/// What a picture is of: the rays of its pixels.
struct PictureView {
  Camera camera;
  std::uint32_t width = 0, height = 0;
};

/// Where a ray of the picture meets a surface, whose normals look towards the viewer.
struct SeenSurface {
  const Surface& surface;
  Vec3 to_viewer;      ///< unit vector against the ray
  float x = 0, y = 0;  ///< in the picture, in pixels from its upper left corner
};

class ClientLight {
 public:
  ClientLight() = default;
  virtual ~ClientLight() = default;
  ClientLight(const ClientLight&) = delete;
  ClientLight& operator=(const ClientLight&) = delete;

  /// Before each picture; for what is done in the picture's own space. The scene is in its state.
  virtual void prepare(const RayScene& /*scene*/, const PictureView& /*view*/,
                       ThreadPool& /*pool*/) {}
  /// Irradiance over π that the surface receives by other surfaces and the sky. Many threads at
  /// once, between prepare() and the next change of the light.
  [[nodiscard]] virtual Vec3 irradiance(const SeenSurface& seen) const = 0;
};

}  // namespace gicodec::ddgi
