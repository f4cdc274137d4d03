#include "probe_rays.h"

#include "gather.h"
#include "lighting.h"

#include <array>

namespace gicodec::ddgi {

void trace_probe(const RayScene& scene, Vec3 position, std::span<const Vec3> directions,
                 std::span<ProbeRay> out, RayCount& count) {
  const auto light = [&](const Surface& hit) { return direct_light(scene, hit, count.shadow); };
  gather(scene, position, directions, 4 * kPi, count.probe, light,
         [&](std::size_t i, Vec3 radiance, const Surface* hit) {
           ProbeRay& ray = out[i] = {};
           ray.direct = ray.radiance = radiance;
           ray.distance = hit == nullptr ? 1e30F : hit->distance;
           if (hit == nullptr) return;
           ray.end = hit->back ? RayEnd::back : RayEnd::front;
           if (hit->back) return;
           ray.albedo = hit->albedo;
           ray.position = hit->position;
           ray.normal = hit->normal;
         });
}

void find_cages(const ProbeField& field, std::span<const Vec3> directions,
                std::span<ProbeRay> rays) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ProbeRay& ray = rays[i];
    if (ray.end != RayEnd::front) continue;
    ray.cage = field.cage(ray.position, ray.normal, -directions[i]);
    ray.fetch = field.fetch(ray.normal);
  }
}

Vec3 bounce(const ProbeField& field, const ProbeRay& ray) {
  return ray.direct + ray.albedo * field.irradiance(ray.cage, ray.fetch);
}

void blend_irradiance(const RaySet& set, std::span<const ProbeRay> rays, std::span<Vec3> out) {
  constexpr std::size_t n = RaySet::kTile;  // their sums stay in registers
  for (std::size_t first = 0; first < out.size(); first += n) {
    std::array<float, n> r{}, g{}, b{}, total{};
    const float* weights = &set.irradiance[first];
    for (const ProbeRay& ray : rays) {
      if (ray.end != RayEnd::back) {
        const Vec3 c = ray.radiance;
        for (std::size_t t = 0; t < n; ++t) {
          r[t] += weights[t] * c.x;
          g[t] += weights[t] * c.y;
          b[t] += weights[t] * c.z;
          total[t] += weights[t];
        }
      }
      weights += set.stride;
    }
    for (std::size_t t = 0; t < std::min(n, out.size() - first); ++t) {
      const float scale = total[t] > 1e-6F ? 1 / total[t] : 0;
      out[first + t] = {r[t] * scale, g[t] * scale, b[t] * scale};
    }
  }
}

void blend_visibility(const RaySet& set, std::span<const ProbeRay> rays, float cap,
                      std::span<Vec2> out) {
  for (std::size_t t = 0; t < out.size(); ++t) {
    float mean = 0, squared = 0, total = 0;
    for (std::uint32_t i = set.visibility_begin[t]; i < set.visibility_begin[t + 1]; ++i) {
      const auto [index, weight] = set.visibility[i];
      const ProbeRay& ray = rays[index];
      const float seen = ray.end == RayEnd::back ? ray.distance * 0.2F : ray.distance;
      const float d = std::min(seen, cap);
      mean += weight * d;
      squared += weight * (d * d);
      total += weight;
    }
    out[t] = total > 0 ? Vec2{mean / total, squared / total} : Vec2{cap, cap * cap};
  }
}

}  // namespace gicodec::ddgi
