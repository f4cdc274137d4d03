#include "client_renderer.h"

#include "lighting.h"

namespace gicodec::ddgi {
namespace {

/// From the finer volume where that has active probes around the point.
Vec3 indirect(const ProbeField& field, const ProbeField* fine, const Surface& hit, Vec3 to_viewer) {
  if (fine != nullptr && fine->holds(hit.position)) {
    const Cage cage = fine->cage(hit.position, hit.normal, to_viewer);
    const auto lit = [](float weight) { return weight > 0; };
    if (std::any_of(cage.weight.begin(), cage.weight.end(), lit))
      return fine->irradiance(cage, fine->fetch(hit.normal));
  }
  return field.irradiance(hit.position, hit.normal, to_viewer);
}

Vec3 shade(const RayScene& scene, const ProbeField* field, const ProbeField* fine, Vec3 origin,
           Vec3 direction, float spread, RenderMode mode) {
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
    sum += hit->albedo * indirect(*field, fine, *hit, -direction);
  }
  return sum;
}

}  // namespace

Picture render(const RayScene& scene, const ProbeField* field, const Camera& camera,
               const RenderOptions& options, ThreadPool& pool, const ProbeField* fine) {
  Picture picture{options.width, options.height, {}};
  picture.pixels.resize(std::size_t{options.width} * options.height);
  const Vec3 forward = normalize(camera.target - camera.eye);
  const Vec3 right = normalize(cross(forward, camera.up));
  const Vec3 up = cross(right, forward);
  const auto w = static_cast<float>(options.width), h = static_cast<float>(options.height);
  const float tangent = std::tan(radians(camera.fov_y) / 2);
  const auto n = static_cast<float>(options.samples);
  const float spread = 2 * tangent / (h * n);

  pool.run(options.height, [&](std::size_t row) {
    if (options.stopped != nullptr && options.stopped()) return;
    for (std::uint32_t column = 0; column < options.width; ++column) {
      Vec3 sum;
      for (std::uint32_t i = 0; i < options.samples * options.samples; ++i) {
        const std::uint32_t across = i % options.samples, down = i / options.samples;
        const float sx = (static_cast<float>(across) + 0.5F) / n;
        const float sy = (static_cast<float>(down) + 0.5F) / n;
        const float x = (2 * (static_cast<float>(column) + sx) / w - 1) * tangent * w / h;
        const float y = (1 - 2 * (static_cast<float>(row) + sy) / h) * tangent;
        const Vec3 direction = normalize(forward + right * x + up * y);
        // Bright lamps must not turn into jagged edges: clamp what one sample can add.
        sum += min(shade(scene, field, fine, camera.eye, direction, spread, options.mode),
                   {16, 16, 16});
      }
      picture.pixels[row * options.width + column] = sum / (n * n);
    }
  });
  return picture;
}

}  // namespace gicodec::ddgi
