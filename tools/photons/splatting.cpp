#include "splatting.h"

#include "emission.h"

#include "kinds/tracing.h"

#include <algorithm>
#include <optional>

namespace gicodec::photons {
namespace {

using ddgi::Vec3;
constexpr float kFlatness = 4;        // how much nearer a photon must be along the normal, squared
constexpr float kMinCovered = 0.75F;  // less is taken for this: little is known then

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

  /// The rectangle around one; nothing if that is outside.
  [[nodiscard]] std::optional<Area> operator()(Vec3 center, float radius) const {
    constexpr float kNearest = 0.02F;
    const Vec3 d = center - eye_;
    const float x = ddgi::dot(d, right_), y = ddgi::dot(d, up_), z = ddgi::dot(d, forward_);
    const float near = std::max(z - radius, kNearest), far = z + radius;
    if (!(far > near)) return std::nullopt;
    const auto low = [&](float v) { return v / (v < 0 ? near : far) * scale_; };
    const auto high = [&](float v) { return v / (v < 0 ? far : near) * scale_; };
    const Area area{pixel(middle_x_ + low(x - radius), width_),
                    pixel(middle_x_ + high(x + radius) + 1, width_),
                    pixel(middle_y_ - high(y + radius), height_),
                    pixel(middle_y_ - low(y - radius) + 1, height_)};
    if (area.x0 >= area.x1 || area.y0 >= area.y1) return std::nullopt;
    return area;
  }

 private:
  static std::uint16_t pixel(float at, float end) {
    return static_cast<std::uint16_t>(at > 0 ? std::min(at, end) : 0);  // NaN is 0
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
  const std::uint64_t room = std::max<std::uint64_t>(kMaxTests / photons, 16);
  const Projector project(view, width_, height_);
  std::vector<std::vector<Splat>> splats(batches.size());
  pool.run(batches.size(), [&](std::size_t b) {
    if (batches[b].scale <= 0) return;
    splats[b].reserve(batches[b].photons.size());
    for (std::uint32_t i = 0; i < batches[b].photons.size(); ++i) {
      const HeldPhoton& photon = batches[b].photons[i];
      float radius = photon.radius;
      auto area = project(photon.position, radius);
      if (area && area->size() > room) {
        radius *= std::sqrt(static_cast<float>(room) / static_cast<float>(area->size()));
        area = project(photon.position, radius);
      }
      if (!area || area->size() > 2 * room) continue;
      splats[b].push_back({i, radius, *area});
    }
  });
  for (const auto& of_batch : splats) {
    for (const Splat& splat : of_batch) tests_ += splat.area.size();
  }
  constexpr std::uint32_t kRows = 4;
  pool.run((height_ + kRows - 1) / kRows, [&](std::size_t band) {
    const auto first = static_cast<std::uint32_t>(band) * kRows;
    const std::uint32_t end = std::min(first + kRows, height_);
    for (std::size_t b = 0; b < batches.size(); ++b) {
      for (const Splat& splat : splats[b]) add(batches[b], splat, first, end);
    }
  });
  kinds::for_all(pixels_.size(), pool, [&](std::size_t i) {
    Pixel& pixel = pixels_[i];
    if (pixel.weight > 0)
      pixel.sum *= 1 / std::max(covered(pixel, project, view.camera.eye), kMinCovered);
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

void SplatPicture::add(const HeldPhotons::Batch& batch, const Splat& splat, std::uint32_t first_row,
                       std::uint32_t end_row) {
  const HeldPhoton& photon = batch.photons[splat.photon];
  const float squared = splat.radius * splat.radius;
  // Epanechnikov's kernel over a disc.
  const Vec3 most = photon.flux * (batch.scale * 2 / (ddgi::kPi * squared));
  const Area& area = splat.area;
  const std::uint32_t y1 = std::min<std::uint32_t>(area.y1, end_row);
  for (std::uint32_t y = std::max<std::uint32_t>(area.y0, first_row); y < y1; ++y) {
    for (std::uint32_t x = area.x0; x < area.x1; ++x) {
      Pixel& pixel = pixels_[std::size_t{y} * width_ + x];
      const Vec3 d = photon.position - pixel.position;
      const float distance = ddgi::dot(d, d);
      if (distance >= squared || ddgi::dot(pixel.normal, photon.direction) >= 0) continue;
      const float off = ddgi::dot(d, pixel.normal);
      const float far = (distance + (kFlatness - 1) * off * off) / squared;
      if (!(far < 1)) continue;
      const Vec3 more = most * (1 - far);
      pixel.sum += more;
      pixel.weight += mean(more);
      pixel.radius += mean(more) * splat.radius;
    }
  }
}

float SplatPicture::covered(const Pixel& pixel, const Projector& project, Vec3 eye) const {
  constexpr std::uint32_t kAcross = 16;  // pixels that are looked at, about
  const float radius = pixel.radius / pixel.weight, squared = radius * radius;
  const auto area = project(pixel.position, radius);
  if (!area) return 1;
  const std::uint32_t across = (area->x1 - area->x0) / kAcross + 1;
  const std::uint32_t down = (area->y1 - area->y0) / kAcross + 1;
  const float height = ddgi::dot(pixel.position - eye, pixel.normal);
  float on = 0, all = 0;
  for (std::uint32_t y = area->y0; y < area->y1; y += down) {
    for (std::uint32_t x = area->x0; x < area->x1; x += across) {
      const Pixel& other = pixels_[std::size_t{y} * width_ + x];
      const Vec3 way = other.position - eye, apart = other.position - pixel.position;
      // The plane is at this share of the way to what the other pixel shows.
      const float slope = ddgi::dot(way, pixel.normal), share = height / slope;
      const Vec3 d = eye + way * share - pixel.position;
      const float far = ddgi::dot(d, d) / squared, off = ddgi::dot(apart, pixel.normal);
      if (!(share > 0 && far < 1)) continue;
      const bool same = ddgi::dot(apart, apart) + (kFlatness - 1) * off * off < squared;
      if (!same && !(share < 1)) continue;  // something is in front of the plane
      const float length = ddgi::length(way) * share;
      // Of the kernel, by the area of the plane that the other pixel sees.
      const float weight = (1 - far) * length * length * length / std::abs(slope * share);
      all += weight;
      if (same) on += weight;
    }
  }
  return all > 0 ? on / all : 1;
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
