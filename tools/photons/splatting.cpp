#include "splatting.h"

#include <algorithm>
#include <optional>

namespace gicodec::photons {
namespace {

using ddgi::Vec3;
constexpr float kFlatness = 4;  // how much nearer a photon must be along the normal, squared

}  // namespace

/// Where spheres are in the picture.
class SplatPicture::Projector {
 public:
  Projector(const ddgi::PictureView& view, std::uint32_t width, std::uint32_t height)
      : eye_(view.camera.eye),
        forward_(ddgi::normalize(view.camera.target - view.camera.eye)),
        right_(ddgi::normalize(ddgi::cross(forward_, view.camera.up))),
        up_(ddgi::cross(right_, forward_)),
        // Of small pixels, of which half the large picture's height is the tangent.
        scale_(static_cast<float>(view.height) / 2 / kShrink /
               std::tan(ddgi::radians(view.camera.fov_y) / 2)),
        middle_x_(static_cast<float>(view.width) / 2 / kShrink),
        middle_y_(static_cast<float>(view.height) / 2 / kShrink),
        width_(static_cast<float>(width)),
        height_(static_cast<float>(height)) {}

  /// Of a rectangle around it; nothing if that is outside.
  [[nodiscard]] std::optional<Splat> operator()(const HeldPhoton& photon, float radius) const {
    constexpr float kNearest = 0.02F;
    const Vec3 d = photon.position - eye_;
    const float x = ddgi::dot(d, right_), y = ddgi::dot(d, up_), z = ddgi::dot(d, forward_);
    const float near = std::max(z - radius, kNearest), far = z + radius;
    if (!(far > near)) return std::nullopt;
    const auto low = [&](float v) { return v / (v < 0 ? near : far) * scale_; };
    const auto high = [&](float v) { return v / (v < 0 ? far : near) * scale_; };
    const Splat splat{&photon,
                      radius,
                      0,
                      pixel(middle_x_ + low(x - radius), width_),
                      pixel(middle_x_ + high(x + radius) + 1, width_),
                      pixel(middle_y_ - high(y + radius), height_),
                      pixel(middle_y_ - low(y - radius) + 1, height_)};
    if (splat.x0 >= splat.x1 || splat.y0 >= splat.y1) return std::nullopt;
    return splat;
  }

 private:
  static std::uint32_t pixel(float at, float end) {
    return static_cast<std::uint32_t>(at > 0 ? std::min(at, end) : 0);  // NaN is 0
  }

  Vec3 eye_, forward_, right_, up_;
  float scale_, middle_x_, middle_y_, width_, height_;
};

SplatPicture::SplatPicture(const ddgi::RayScene& scene, const ddgi::PictureView& view,
                           std::span<const HeldPhotons::Batch> batches, ddgi::ThreadPool& pool)
    : width_((view.width + kShrink - 1) / kShrink), height_((view.height + kShrink - 1) / kShrink) {
  see(scene, view, pool);
  std::uint64_t photons = 1;
  for (const auto& batch : batches) photons += batch.photons.size();
  const float room = static_cast<float>(std::max<std::uint64_t>(kMostTests / photons, 16));
  const Projector project(view, width_, height_);
  std::vector<std::vector<Splat>> splats(batches.size());
  pool.run(batches.size(), [&](std::size_t b) {
    if (batches[b].scale <= 0) return;
    for (const HeldPhoton& photon : batches[b].photons) {
      auto splat = project(photon, photon.radius);
      const auto area = [&] {
        return static_cast<float>(splat->x1 - splat->x0) *
               static_cast<float>(splat->y1 - splat->y0);
      };
      if (splat && area() > room) splat = project(photon, splat->radius * std::sqrt(room / area()));
      if (!splat || area() > 2 * room) continue;
      splat->scale = batches[b].scale;
      splats[b].push_back(*splat);
    }
  });
  for (const auto& of_batch : splats) {
    for (const Splat& s : of_batch) tests_ += std::uint64_t{s.x1 - s.x0} * (s.y1 - s.y0);
  }
  constexpr std::uint32_t kRows = 4;
  pool.run((height_ + kRows - 1) / kRows, [&](std::size_t band) {
    const auto first = static_cast<std::uint32_t>(band) * kRows;
    for (const auto& of_batch : splats) {
      for (const Splat& splat : of_batch) add(splat, first, std::min(first + kRows, height_));
    }
  });
}

void SplatPicture::see(const ddgi::RayScene& scene, const ddgi::PictureView& view,
                       ddgi::ThreadPool& pool) {
  constexpr float kMiddle = static_cast<float>(kShrink) / 2;
  const ddgi::PictureRays rays(view);
  spread_ = rays.spread() * kShrink;
  pixels_.resize(std::size_t{width_} * height_);
  pool.run(height_, [&](std::size_t row) {
    for (std::uint32_t column = 0; column < width_; ++column) {
      const Vec3 direction = rays.direction(static_cast<float>(column * kShrink) + kMiddle,
                                            static_cast<float>(row * kShrink) + kMiddle);
      const auto hit = scene.intersect(view.camera.eye, direction, spread_);
      if (!hit) continue;
      Pixel& pixel = pixels_[row * width_ + column];
      pixel.position = hit->position;
      pixel.normal = hit->back ? -hit->normal : hit->normal;
    }
  });
}

void SplatPicture::add(const Splat& splat, std::uint32_t first_row, std::uint32_t end_row) {
  const HeldPhoton& photon = *splat.photon;
  const float squared = splat.radius * splat.radius;
  // Epanechnikov's kernel over a disc.
  const Vec3 most = photon.flux * (splat.scale * 2 / (ddgi::kPi * squared));
  for (std::uint32_t y = std::max(splat.y0, first_row); y < std::min(splat.y1, end_row); ++y) {
    for (std::uint32_t x = splat.x0; x < splat.x1; ++x) {
      Pixel& pixel = pixels_[std::size_t{y} * width_ + x];
      const Vec3 d = photon.position - pixel.position;
      const float distance = ddgi::dot(d, d);
      if (distance >= squared || ddgi::dot(pixel.normal, photon.direction) >= 0) continue;
      const float off = ddgi::dot(d, pixel.normal);
      const float far = (distance + (kFlatness - 1) * off * off) / squared;
      if (far < 1) pixel.sum += most * (1 - far);
    }
  }
}

Vec3 SplatPicture::irradiance(const ddgi::SeenSurface& seen) const {
  const Vec3 position = seen.surface.position, normal = seen.surface.normal;
  const float size = spread_ * std::max(seen.surface.distance, 1e-3F);
  const float x = seen.x / kShrink - 0.5F, y = seen.y / kShrink - 0.5F;
  const float left = std::floor(x), top = std::floor(y);
  Vec3 sum;
  float weights = 0;
  // The four pixels around, and of those around them what shows the same surface, if none does.
  for (const std::int32_t reach : {0, 1, 3}) {
    for (std::int32_t j = -reach; j <= 1 + reach; ++j) {
      for (std::int32_t i = -reach; i <= 1 + reach; ++i) {
        const float px = left + static_cast<float>(i), py = top + static_cast<float>(j);
        if (!(px >= 0 && py >= 0 && px < static_cast<float>(width_) &&
              py < static_cast<float>(height_)))
          continue;
        const Pixel& pixel =
            pixels_[static_cast<std::size_t>(py) * width_ + static_cast<std::size_t>(px)];
        const float alike = std::max(0.0F, ddgi::dot(normal, pixel.normal));
        const float off = ddgi::dot(normal, pixel.position - position) / size;
        const float width = static_cast<float>(reach) + 1;
        const float tent = std::max(0.0F, 1 - std::abs(px - x) / width) *
                           std::max(0.0F, 1 - std::abs(py - y) / width);
        const float a2 = alike * alike, weight = tent * a2 * a2 * a2 / (1 + 16 * off * off);
        if (!(weight > 1e-6F)) continue;
        sum += pixel.sum * weight;
        weights += weight;
      }
    }
    if (weights > 1e-2F) break;
  }
  return weights > 0 ? sum / weights : Vec3{};
}

}  // namespace gicodec::photons
