#include "reference.h"

#include "photons/emission.h"

#include "ddgi/lighting.h"
#include "ddgi/noise.h"
#include "kinds/tracing.h"

#include <cstring>

namespace gicodec::photons {
namespace {

using ddgi::Vec3;

std::uint32_t seed_of(float x, float y) {
  std::uint32_t bits[2];
  std::memcpy(&bits[0], &x, sizeof x);
  std::memcpy(&bits[1], &y, sizeof y);
  return ddgi::hash(bits[0], bits[1]);
}

}  // namespace

Vec3 GatheredLight::irradiance(const ddgi::SeenSurface& seen) const {
  constexpr std::uint32_t kMaxHits = 32;
  constexpr float kSpread = 0.02F;
  const std::uint32_t seed = seed_of(seen.x, seen.y);
  Vec3 sum;
  std::uint64_t rays = 0;
  for (std::uint32_t path = 0; path < paths_; ++path) {
    ddgi::Random random(ddgi::hash(seed, path));
    const auto first = even_numbers(seed, path);
    Vec3 normal = seen.surface.normal, geometric = seen.surface.geometric_normal;
    Vec3 origin = ddgi::leave(seen.surface, geometric);
    Vec3 weight{1, 1, 1};
    float u = first[0], v = first[1];
    for (std::uint32_t hits = 0; hits < kMaxHits; ++hits) {
      const Vec3 direction = kinds::cosine_direction(normal, u, v);
      if (ddgi::dot(direction, geometric) <= 0) break;
      const auto surface = scene_.intersect(origin, direction, kSpread);
      if (!surface || surface->back) break;
      const float survives = std::max({surface->albedo.x, surface->albedo.y, surface->albedo.z});
      sum += weight * surface->albedo * direct_light(scene_, *surface, rays);
      if (random.next() >= survives) break;
      weight = weight * surface->albedo / survives;
      normal = surface->normal;
      geometric = surface->geometric_normal;
      origin = ddgi::leave(*surface, geometric);
      u = random.next();
      v = random.next();
    }
  }
  return sum / static_cast<float>(paths_);
}

}  // namespace gicodec::photons
