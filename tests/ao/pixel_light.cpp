#include "pixel_light.h"

#include "ao/point_light.h"

#include "ddgi/client_renderer.h"
#include "ddgi/noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gicodec::ao {
namespace {

using ddgi::Vec3;

constexpr std::int32_t kPattern = 4;  // pixels

Vec3 light_of(float visible) { return Vec3{1, 1, 1} * (kAmbientLight * visible); }

}  // namespace

Vec3 TracedLight::irradiance(const ddgi::SeenSurface& seen) const {
  const auto x = static_cast<std::uint32_t>(seen.x * 16),
             y = static_cast<std::uint32_t>(seen.y * 16);
  return light_of(hemisphere_.visible(scene_, seen.surface.position, seen.surface.geometric_normal,
                                      frame_around(seen.surface.normal), ddgi::hash(x, y)));
}

ScreenSpaceLight::ScreenSpaceLight(std::uint32_t samples, float radius)
    : samples_(samples), radius_(radius) {
  ddgi::Random random(1);
  for (std::uint32_t i = 0; i < samples; ++i) {
    const float z = random.next(), angle = 2 * ddgi::kPi * random.next(),
                across = std::sqrt(1 - z * z);
    const float share = static_cast<float>(i + 1) / static_cast<float>(samples);
    samples_[i] =
        Vec3{across * std::cos(angle), across * std::sin(angle), z} * ddgi::mix(0.1F, 1, share);
  }
}

void ScreenSpaceLight::prepare(const ddgi::RayScene& scene, const ddgi::PictureView& view,
                               ddgi::ThreadPool& pool) {
  width_ = view.width, height_ = view.height;
  const ddgi::PictureRays rays(view);
  const Vec3 eye = view.camera.eye, forward = normalize(view.camera.target - eye);
  const Vec3 right = normalize(cross(forward, view.camera.up)), down = cross(forward, right);
  const float focal =
      static_cast<float>(height_) / (2 * std::tan(ddgi::radians(view.camera.fov_y) / 2));
  const auto half_width = static_cast<float>(width_) / 2,
             half_height = static_cast<float>(height_) / 2;
  const auto seen_by_camera = [&](Vec3 v) {
    return Vec3{dot(v, right), dot(v, down), dot(v, forward)};
  };
  constexpr float kFar = std::numeric_limits<float>::infinity();
  std::vector<Pixel> pixels(std::size_t{width_} * height_);
  pool.run(height_, [&](std::size_t y) {
    for (std::uint32_t x = 0; x < width_; ++x) {
      Pixel& pixel = pixels[y * width_ + x];
      const Vec3 direction =
          rays.direction(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
      const auto hit = scene.intersect(eye, direction, rays.spread());
      pixel.position = {0, 0, kFar};
      if (!hit) continue;
      pixel.position = seen_by_camera(hit->position - eye);
      pixel.normal = seen_by_camera(hit->back ? -hit->normal : hit->normal);
    }
  });

  std::vector<float> raw(pixels.size(), 1);
  pool.run(height_, [&](std::size_t y) {
    for (std::uint32_t x = 0; x < width_; ++x) {
      const Pixel& pixel = pixels[y * width_ + x];
      if (pixel.position.z == kFar) continue;
      const auto turn = static_cast<float>(y % kPattern * kPattern + x % kPattern);
      const float angle = 2 * ddgi::kPi * turn * 7 / (kPattern * kPattern);
      Vec3 u, v;
      ddgi::basis(pixel.normal, u, v);
      const Vec3 s = u * std::cos(angle) + v * std::sin(angle),
                 t = v * std::cos(angle) - u * std::sin(angle);
      std::uint32_t occluded = 0;
      for (const Vec3 sample : samples_) {
        const Vec3 p =
            pixel.position + (s * sample.x + t * sample.y + pixel.normal * sample.z) * radius_;
        if (!(p.z > 0)) continue;
        const float px = half_width + focal * p.x / p.z, py = half_height + focal * p.y / p.z;
        if (!(px >= 0 && py >= 0 && px < static_cast<float>(width_) &&
              py < static_cast<float>(height_)))
          continue;
        const float depth =
            pixels[static_cast<std::size_t>(py) * width_ + static_cast<std::size_t>(px)].position.z;
        const bool in_front = depth < p.z - 0.005F * radius_;
        if (in_front && std::abs(depth - pixel.position.z) < radius_) ++occluded;
      }
      raw[y * width_ + x] = 1 - static_cast<float>(occluded) / static_cast<float>(samples_.size());
    }
  });

  visible_.assign(pixels.size(), 1);
  pool.run(height_, [&](std::size_t row) {
    const auto y = static_cast<std::int32_t>(row), w = static_cast<std::int32_t>(width_),
               h = static_cast<std::int32_t>(height_);
    for (std::int32_t x = 0; x < w; ++x) {
      const float depth = pixels[row * width_ + static_cast<std::size_t>(x)].position.z;
      float sum = 0, count = 0;
      for (std::int32_t i = 0; i < kPattern * kPattern; ++i) {
        const std::int32_t nx = std::clamp(x + i % kPattern - kPattern / 2, 0, w - 1);
        const std::int32_t ny = std::clamp(y + i / kPattern - kPattern / 2, 0, h - 1);
        const auto other = static_cast<std::size_t>(ny) * width_ + static_cast<std::size_t>(nx);
        if (!(std::abs(pixels[other].position.z - depth) < radius_ / 4)) continue;
        sum += raw[other], ++count;
      }
      if (count > 0) visible_[row * width_ + static_cast<std::size_t>(x)] = sum / count;
    }
  });
}

Vec3 ScreenSpaceLight::irradiance(const ddgi::SeenSurface& seen) const {
  const auto x = static_cast<std::uint32_t>(seen.x), y = static_cast<std::uint32_t>(seen.y);
  return x < width_ && y < height_ ? light_of(visible_[std::size_t{y} * width_ + x]) : light_of(1);
}

}  // namespace gicodec::ao
