#include "lighting.h"

namespace gicodec::ddgi {
namespace {

constexpr float kDarkest = 2e-5F;  // light below this is not worth a shadow ray

struct Receiver {
  const RayScene& scene;
  const Surface& surface;
  Vec3 origin;
  std::uint64_t& rays;

  [[nodiscard]] bool visible(Vec3 direction, float distance) const {
    if (dot(direction, surface.geometric_normal) <= 0) return false;
    ++rays;
    return !scene.occluded(origin, direction, distance);
  }
};

float brightest(Vec3 c) { return std::max({c.x, c.y, c.z}); }

Vec3 sun(const Light& light, const Receiver& at) {
  const Vec3 to = -light.direction;
  const float cosine = dot(at.surface.normal, to);
  if (cosine <= 0 || brightest(light.colour) * cosine < kDarkest || !at.visible(to, 1e30F))
    return {};
  return light.colour * (cosine / kPi);
}

/// A point, or a spot's cone.
Vec3 point(const Light& light, const Receiver& at) {
  const Vec3 d = light.position - at.surface.position;
  const float squared = dot(d, d), distance = std::sqrt(squared);
  if (distance <= 0) return {};
  const Vec3 to = d / distance;
  float factor = dot(at.surface.normal, to) / (squared * kPi);
  if (light.type == LightType::spot) {
    factor *= smoothstep(light.cos_outer, light.cos_inner, -dot(to, light.direction));
  }
  if (factor <= 0 || brightest(light.colour) * factor < kDarkest) return {};
  return at.visible(to, distance * 0.999F) ? light.colour * factor : Vec3{};
}

/// The mean over the centres of the rectangle's quarters.
Vec3 area(const Light& light, const Receiver& at) {
  const float quarter = length(cross(light.half_u, light.half_v));
  Vec3 sum;
  for (int i = 0; i < 4; ++i) {
    const Vec3 p = light.position + light.half_u * (i & 1 ? 0.5F : -0.5F) +
                   light.half_v * (i & 2 ? 0.5F : -0.5F);
    const Vec3 d = p - at.surface.position;
    const float squared = dot(d, d), distance = std::sqrt(squared);
    if (distance <= 0) continue;
    const Vec3 to = d / distance;
    const float from = -dot(to, light.direction);
    const float factor =
        dot(at.surface.normal, to) * from * quarter / (std::max(squared, quarter) * kPi);
    if (from <= 0 || factor <= 0 || brightest(light.colour) * factor < kDarkest) continue;
    if (at.visible(to, distance * 0.999F)) sum += light.colour * factor;
  }
  return sum;
}

}  // namespace

Vec3 direct_light(const RayScene& scene, const Surface& surface, std::uint64_t& rays) {
  const Receiver at{scene, surface, leave(surface, surface.geometric_normal), rays};
  Vec3 sum;
  for (const Light& light : scene.state().lights) {
    switch (light.type) {
      case LightType::sun:
        sum += sun(light, at);
        break;
      case LightType::point:
      case LightType::spot:
        sum += point(light, at);
        break;
      case LightType::area:
        sum += area(light, at);
        break;
    }
  }
  return sum;
}

}  // namespace gicodec::ddgi
