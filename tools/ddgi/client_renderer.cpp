#include "client_renderer.h"

#include "lighting.h"

namespace gicodec::ddgi {
namespace {

struct Place {
  float x, y;
};

Vec3 shade(const RayScene& scene, const ClientLight* light, Vec3 origin, Vec3 direction,
           float spread, RenderMode mode, Place at) {
  auto hit = scene.intersect(origin, direction, spread);
  if (!hit) return mode == RenderMode::gi ? Vec3{} : scene.state().sky.radiance(direction);
  if (hit->back) {
    hit->geometric_normal = -hit->geometric_normal;
    hit->normal = -hit->normal;
  }
  Vec3 sum;
  if (mode != RenderMode::gi) {
    std::uint64_t rays = 0;
    sum += hit->emission + hit->albedo * direct_light(scene, *hit, rays);
  }
  if (mode != RenderMode::direct) {
    sum += hit->albedo * light->irradiance({*hit, -direction, at.x, at.y});
  }
  return sum;
}

}  // namespace

PictureRays::PictureRays(const PictureView& view)
    : forward_(normalize(view.camera.target - view.camera.eye)),
      right_(normalize(cross(forward_, view.camera.up))),
      up_(cross(right_, forward_)),
      tangent_(std::tan(radians(view.camera.fov_y) / 2)),
      width_(static_cast<float>(view.width)),
      height_(static_cast<float>(view.height)) {}

Vec3 PictureRays::direction(float x, float y) const {
  const float across = (2 * x / width_ - 1) * tangent_ * width_ / height_;
  const float up = (1 - 2 * y / height_) * tangent_;
  return normalize(forward_ + right_ * across + up_ * up);
}

Picture render(const RayScene& scene, ClientLight* light, const Camera& camera,
               const RenderOptions& options, ThreadPool& pool) {
  Picture picture{options.width, options.height, {}};
  picture.pixels.resize(std::size_t{options.width} * options.height);
  const PictureView view{camera, options.width, options.height};
  const PictureRays rays(view);
  const auto n = static_cast<float>(options.samples);
  const float spread = rays.spread() / n;
  if (options.mode != RenderMode::direct) light->prepare(scene, view, pool);

  pool.run(options.height, [&](std::size_t row) {
    if (options.stopped != nullptr && options.stopped()) return;
    for (std::uint32_t column = 0; column < options.width; ++column) {
      Vec3 sum;
      for (std::uint32_t i = 0; i < options.samples * options.samples; ++i) {
        const std::uint32_t across = i % options.samples, down = i / options.samples;
        const float x = static_cast<float>(column) + (static_cast<float>(across) + 0.5F) / n;
        const float y = static_cast<float>(row) + (static_cast<float>(down) + 0.5F) / n;
        // Bright lamps must not turn into jagged edges: clamp what one sample can add.
        sum +=
            min(shade(scene, light, camera.eye, rays.direction(x, y), spread, options.mode, {x, y}),
                {16, 16, 16});
      }
      picture.pixels[row * options.width + column] = sum / (n * n);
    }
  });
  return picture;
}

}  // namespace gicodec::ddgi
