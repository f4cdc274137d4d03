#include "client_camera.h"

#include "dump/error.h"

#include <algorithm>
#include <cmath>

namespace gicodec::streaming {

using ddgi::Camera;
using ddgi::Vec3;
using tools::Exit;
using tools::fail;

namespace {

constexpr double kOrbitSeconds = 20;
constexpr float kOrbitRadius = 0.25F;  // of the volume's size

Camera parse(const std::string& text) {
  const auto commas = std::count(text.begin(), text.end(), ',');
  const auto n = kinds::numbers(text, commas == 6 ? 7 : 6, "--camera");
  Camera camera{.eye = {n[0], n[1], n[2]}, .target = {n[3], n[4], n[5]}};
  if (n.size() == 7) camera.fov_y = std::clamp(n[6], 1.0F, 170.0F);
  if (length(cross(camera.target - camera.eye, camera.up)) < 1e-6F) camera.up = {0, 0, -1};
  if (camera.eye == camera.target) fail(Exit::usage, "--camera: eye and target are the same point");
  return camera;
}

}  // namespace

void add_camera_flags(tools::Command& app, CameraFlags& flags) {
  auto* camera =
      app.add_option("--camera", flags.camera,
                     "Eye and target, and the vertical angle of view in degrees; default: the "
                     "scene's camera at each frame's time")
          ->type_name("X,Y,Z,X,Y,Z[,DEGREES]");
  app.add_flag("--orbit", flags.orbit, "Go around the middle of the scene's volume in 20 seconds")
      ->excludes(camera);
}

CameraPath::CameraPath(const CameraFlags& flags, const ddgi::Scene* scene)
    : scene_(scene), orbit_(flags.orbit) {
  if (!flags.camera.empty()) fixed_ = parse(flags.camera);
  if (orbit_ && scene == nullptr) fail(Exit::usage, "--orbit needs --scene or --gltf");
}

Camera CameraPath::at(double time) const {
  if (fixed_) {
    Camera camera = *fixed_;
    if (scene_ != nullptr) camera.exposure = scene_->camera_at(time).exposure;
    return camera;
  }
  Camera camera = scene_->camera_at(time);
  if (!orbit_) return camera;
  const auto angle = static_cast<float>(std::fmod(time / kOrbitSeconds, 1.0) * 2) * ddgi::kPi;
  const Vec3 size = scene_->volume.size();
  camera.target = scene_->volume.center();
  camera.eye = camera.target + Vec3{std::cos(angle) * size.x * kOrbitRadius, 0,
                                    std::sin(angle) * size.z * kOrbitRadius};
  camera.up = {0, 1, 0};
  return camera;
}

Viewpoint viewpoint(const Camera& camera, float aspect, double time) {
  return {
      position(camera.eye),    position(camera.target), position(camera.up), camera.fov_y, aspect,
      static_cast<float>(time)};
}

}  // namespace gicodec::streaming
