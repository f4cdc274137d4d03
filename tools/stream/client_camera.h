// The camera of a client.
#pragma once

#include "ddgi/scene.h"
#include "programs/scene_flags.h"

#include <gicodec/protocol.h>

#include <optional>
#include <string>

namespace gicodec::streaming {

struct CameraFlags {
  std::string camera;  ///< "X,Y,Z,X,Y,Z[,DEGREES]"; empty for the scene's own path
  bool orbit = false;
};

void add_camera_flags(tools::Command& app, CameraFlags& flags);

class CameraPath {
 public:
  /// `scene` may be nullptr, must outlive it. Throws tools::Error of Exit::usage.
  CameraPath(const CameraFlags& flags, const ddgi::Scene* scene);

  /// False if neither flags nor a scene give a camera.
  [[nodiscard]] bool known() const { return fixed_.has_value() || scene_ != nullptr; }
  /// Precondition: known().
  [[nodiscard]] ddgi::Camera at(double time) const;

 private:
  const ddgi::Scene* scene_;
  std::optional<ddgi::Camera> fixed_;
  bool orbit_;
};

[[nodiscard]] Viewpoint viewpoint(const ddgi::Camera& camera, float aspect, double time);

}  // namespace gicodec::streaming
