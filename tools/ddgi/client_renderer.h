// The thin client: primary visibility and direct light traced, diffuse indirect light from what it
// received.
#pragma once

#include "client_light.h"

#include <vector>

namespace gicodec::ddgi {

enum class RenderMode : std::uint8_t {
  full,    ///< direct and indirect light
  direct,  ///< lights and emission only
  gi,      ///< indirect light only
};

struct RenderOptions {
  std::uint32_t width = 960, height = 540;
  std::uint32_t samples = 2;  ///< rays per pixel in each direction, on a fixed grid
  RenderMode mode = RenderMode::full;
  bool (*stopped)() noexcept = nullptr;  ///< asked before each row; once true, rows stay black
};

/// Linear radiance, row by row from the top.
struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<Vec3> pixels;
};

/// The ray through a place of a picture, in pixels from its upper left corner.
class PictureRays {
 public:
  explicit PictureRays(const PictureView& view);
  [[nodiscard]] Vec3 direction(float x, float y) const;
  /// Width of a pixel's cone per metre of distance.
  [[nodiscard]] float spread() const { return 2 * tangent_ / height_; }

 private:
  Vec3 forward_, right_, up_;
  float tangent_, width_, height_;
};

/// Draws the scene in the state it is in. The same light gives the same bits, whatever the number
/// of threads. `light` may be nullptr for RenderMode::direct.
[[nodiscard]] Picture render(const RayScene& scene, ClientLight* light, const Camera& camera,
                             const RenderOptions& options, ThreadPool& pool);

}  // namespace gicodec::ddgi
