#include "gather.h"

#include "ddgi/lighting.h"
#include "kinds/tracing.h"

#include <array>
#include <atomic>
#include <cmath>

namespace gicodec::maps {

using namespace ddgi;

namespace {

constexpr float kInside = 0.1F;                      // texels by which samples keep off edges
constexpr std::uint32_t kProbes = 16, kBuried = 14;  // rays of which so many end at insides
constexpr float kOffset = 1e-3F;                     // metres that rays start off a surface
constexpr float kLift = 0.5F;                        // texels likewise, if not from there

/// Van der Corput's sequence in base 2.
float radical_inverse(std::uint32_t i) {
  i = i << 16 | i >> 16;
  i = (i & 0x00FF00FFU) << 8 | (i & 0xFF00FF00U) >> 8;
  i = (i & 0x0F0F0F0FU) << 4 | (i & 0xF0F0F0F0U) >> 4;
  i = (i & 0x33333333U) << 2 | (i & 0xCCCCCCCCU) >> 2;
  i = (i & 0x55555555U) << 1 | (i & 0xAAAAAAAAU) >> 1;
  return unit(i);
}

/// Where rays start: on the surface, and where nearly all of them end at insides, above it. What
/// stands over a sample by a little, such as a slab that overlaps the next one, is not to darken
/// the texels around.
std::array<Vec3, 2> origins_of(const Parameterisation& map, const MapPoint& point) {
  return {point.position + point.geometric_normal * kOffset,
          point.position + point.geometric_normal * (kLift / map.density())};
}

float wrapped(float a) { return a >= 1 ? a - 1 : a; }

}  // namespace

MapPoint point_of(const Parameterisation& map, const RayScene& scene, const MapTexel& texel) {
  const Instance& instance = map.instance_of(texel.triangle);
  const Mesh& mesh = scene.scene().meshes[instance.mesh];
  const Affine& place = scene.state().transforms[instance.object];
  const auto& [a, b, c] = mesh.triangles[texel.triangle - instance.first];
  const Vec3 p = place.point(mesh.positions[a]), q = place.point(mesh.positions[b]),
             r = place.point(mesh.positions[c]);
  const float w = 1 - texel.u - texel.v;
  MapPoint out;
  out.position = p * w + q * texel.u + r * texel.v;
  const Vec3 inwards = (p + q + r) / 3 - out.position;
  const float far = length(inwards), step = kInside / map.density();
  out.position += inwards * (far > step ? step / far : 1);
  out.geometric_normal = normalize(cross(q - p, r - p));
  if (place.determinant() < 0) out.geometric_normal = -out.geometric_normal;
  out.normal = normalize(
      place.normal(mesh.normals[a] * w + mesh.normals[b] * texel.u + mesh.normals[c] * texel.v));
  if (!(dot(out.normal, out.geometric_normal) > 0.2F)) out.normal = out.geometric_normal;
  return out;
}

std::vector<MapTexel> open_texels(const Parameterisation& map, const RayScene& scene,
                                  ThreadPool& pool) {
  const auto texels = map.texels();
  std::vector<std::uint8_t> open(texels.size(), 1);
  kinds::for_all(texels.size(), pool, [&](std::size_t i) {
    if (scene.scene().objects[map.instance_of(texels[i].triangle).object].dynamic) return;
    const MapPoint point = point_of(map, scene, texels[i]);
    const auto within = [&](Vec3 origin) {
      std::uint32_t behind = 0;
      for (std::uint32_t ray = 0; ray < kProbes; ++ray) {
        const float u = (static_cast<float>(ray) + 0.5F) / kProbes;
        behind += scene.behind_static_surface(
            origin, kinds::cosine_direction(point.geometric_normal, u, radical_inverse(ray)));
      }
      return behind >= kBuried;
    };
    const std::array<Vec3, 2> origins = origins_of(map, point);
    open[i] = within(origins[0]) && within(origins[1]) ? 0 : 1;
  });
  std::vector<MapTexel> out;
  for (std::size_t i = 0; i < texels.size(); ++i) {
    if (open[i] != 0) out.push_back(texels[i]);
  }
  return out;
}

void light_directly(const Parameterisation& map, const RayScene& scene,
                    std::span<const MapTexel> at, ThreadPool& pool, std::span<Vec3> direct,
                    GatherCount& count) {
  std::atomic<std::uint64_t> shadow_rays{0};
  kinds::for_all(at.size(), pool, [&](std::size_t i) {
    const MapPoint point = point_of(map, scene, at[i]);
    Surface surface;
    surface.position = point.position;
    surface.geometric_normal = point.geometric_normal;
    surface.normal = point.normal;
    std::uint64_t rays = 0;
    direct[at[i].place] = direct_light(scene, surface, rays);
    shadow_rays += rays;
  });
  count.shadow_rays += shadow_rays;
}

void gather(const Parameterisation& map, const RayScene& scene, std::span<const MapTexel> at,
            std::span<const Vec3> lit, std::span<const std::uint8_t> exists,
            const GatherOptions& options, std::uint32_t update, ThreadPool& pool,
            std::span<Vec3> out, GatherCount& count) {
  const std::uint32_t seed = options.seed_of(update);
  const auto n = static_cast<float>(options.rays);
  std::atomic<std::uint64_t> rays{0};
  kinds::for_all(at.size(), pool, [&](std::size_t i) {
    const MapPoint point = point_of(map, scene, at[i]);
    const std::uint32_t turn = hash(options.turned ? at[i].place : 0, seed);
    const float first = unit(turn), second = unit(hash(turn));
    thread_local std::vector<Vec3> directions;
    directions.resize(options.rays);
    for (std::uint32_t ray = 0; ray < options.rays; ++ray) {
      directions[ray] = kinds::cosine_direction(
          point.normal, wrapped((static_cast<float>(ray) + 0.5F) / n + first),
          wrapped(radical_inverse(ray) + second));
    }
    const auto light = [&](const Surface& hit) { return blend(map.taps(hit), lit, exists); };
    Vec3 sum;
    std::uint64_t mine = 0;
    std::size_t met = 0;
    for (const Vec3 origin : origins_of(map, point)) {
      sum = {};
      met = options.rays -
            ddgi::gather(scene, origin, directions, 2 * kPi, mine, light,
                         [&](std::size_t, Vec3 radiance, const Surface*) { sum += radiance; });
      if (std::uint64_t{kProbes} * met > std::uint64_t{kProbes - kBuried} * options.rays) break;
    }
    rays += mine;
    out[i] = met > 0 ? sum / static_cast<float>(met) : Vec3{};
  });
  count.rays += rays;
}

}  // namespace gicodec::maps
