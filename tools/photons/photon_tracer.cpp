#include "photon_tracer.h"

#include "radius.h"

#include "ddgi/noise.h"
#include "kinds/tracing.h"

namespace gicodec::photons {
namespace {

using ddgi::Vec3;

constexpr std::uint32_t kMaxHits =
    32;  // of one photon; one that got so far carries next to nothing
constexpr float kSpread = 0.02F;
constexpr float kFar = 1e5F;

struct Hit {
  Vec3 position, direction, power;
};

struct Paths {
  std::vector<Hit> stored;
  std::vector<Segment> segments;
};

/// From a light of 1 watt on until it is absorbed or leaves the scene.
void follow(const ddgi::RayScene& scene, Emission ray, Vec3 power, ddgi::Random& random,
            Paths& out) {
  for (std::uint32_t hits = 0; hits < kMaxHits; ++hits) {
    const auto surface = scene.intersect(ray.origin, ray.direction, kSpread);
    out.segments.push_back(
        {ray.origin, surface ? surface->position : ray.origin + ray.direction * kFar});
    if (!surface || surface->back) return;
    if (hits > 0) out.stored.push_back({surface->position, ray.direction, power});
    const Vec3 albedo = surface->albedo;
    const float survives = std::max({albedo.x, albedo.y, albedo.z});
    if (random.next() >= survives) return;
    power = power * albedo / survives;
    ray.origin = ddgi::leave(*surface, surface->geometric_normal);
    const float u = random.next(), v = random.next();
    ray.direction = kinds::cosine_direction(surface->normal, u, v);
    // An interpolated normal may send it into the surface: back out, as in a mirror.
    const Vec3 n = surface->geometric_normal;
    const float up = ddgi::dot(ray.direction, n);
    if (up < 0) ray.direction = ray.direction - n * (2 * up);
  }
}

/// In runs, so that many threads share them.
template <typename Numbers>
std::vector<Paths> trace(const ddgi::RayScene& scene, const Emitter& emitter, std::uint32_t seed,
                         std::uint32_t count, std::uint32_t run_size, ddgi::ThreadPool& pool,
                         const Numbers& numbers) {
  const ddgi::Light& light = emitter.light();
  std::vector<Paths> runs((count + run_size - 1) / run_size);
  pool.run(runs.size(), [&](std::size_t run) {
    const auto begin = static_cast<std::uint32_t>(run) * run_size;
    for (std::uint32_t i = begin; i < std::min(begin + run_size, count); ++i) {
      ddgi::Random random(ddgi::hash(seed, i));
      follow(scene, emitter.emit(numbers(i)), light.colour / mean(light.colour), random, runs[run]);
    }
  });
  return runs;
}

Paths joined(std::span<const Paths> runs) {
  Paths all;
  for (const Paths& run : runs) {
    all.stored.insert(all.stored.end(), run.stored.begin(), run.stored.end());
    all.segments.insert(all.segments.end(), run.segments.begin(), run.segments.end());
  }
  return all;
}

/// To whole steps of a power of two, so that the box is the same, and photons have the same codes,
/// when a batch is shot again and few paths changed.
ddgi::Box widened(const ddgi::Box& box, float step) {
  const float s = std::ldexp(1.0F, std::ilogb(step));
  const auto low = [s](float v) { return std::floor(v / s) * s; };
  const auto high = [s](float v) { return std::ceil(v / s) * s; };
  return {{low(box.lo.x), low(box.lo.y), low(box.lo.z)},
          {high(box.hi.x), high(box.hi.y), high(box.hi.z)}};
}

ddgi::Box box_of(const PhotonBatch& batch) {
  const auto& [x, y, z] = batch.minimum;
  const auto& [width, height, depth] = batch.extent;
  return {{x, y, z}, {x + width, y + height, z + depth}};
}

/// The former box where it is hardly larger: photons that come and go at the rim do not move
/// others.
ddgi::Box steady(const ddgi::Box& former, const ddgi::Box& box) {
  constexpr float kMax = 1.25F;
  const auto holds = [](float lo, float hi, float from, float to) {
    return lo <= from && hi >= to && hi - lo <= kMax * (to - from);
  };
  const bool all = holds(former.lo.x, former.hi.x, box.lo.x, box.hi.x) &&
                   holds(former.lo.y, former.hi.y, box.lo.y, box.hi.y) &&
                   holds(former.lo.z, former.hi.z, box.lo.z, box.hi.z);
  return all ? former : box;
}

}  // namespace

bool any_inside(std::span<const Segment> segments, const ddgi::Box& box) {
  const auto inside = [&box](const Segment& s) {
    float begin = 0, end = 1;
    const auto slab = [&](float from, float to, float lo, float hi) {
      const float d = to - from;
      if (d == 0) return from >= lo && from <= hi;
      const float a = (lo - from) / d, b = (hi - from) / d;
      begin = std::max(begin, std::min(a, b));
      end = std::min(end, std::max(a, b));
      return begin <= end;
    };
    return slab(s.from.x, s.to.x, box.lo.x, box.hi.x) &&
           slab(s.from.y, s.to.y, box.lo.y, box.hi.y) && slab(s.from.z, s.to.z, box.lo.z, box.hi.z);
  };
  return std::any_of(segments.begin(), segments.end(), inside);
}

Projection project(const ddgi::RayScene& scene, const Sphere& reach, std::uint32_t light,
                   std::uint32_t seed, ddgi::ThreadPool& pool) {
  constexpr std::uint32_t kPaths = 4, kSide = Emitter::kSide;  // paths for each cell
  const Emitter whole(scene.state().lights[light], reach);
  if (whole.light().type != ddgi::LightType::sun || !(whole.watts() > 0)) return {whole, {}};
  const auto runs =
      trace(scene, whole, ddgi::hash(seed, ~light), Emitter::kCells * kPaths, kPaths, pool,
            [](std::uint32_t i) {
              const std::uint32_t number = i / kPaths;
              const float cell = (static_cast<float>(number) + 0.5F) / Emitter::kCells;
              const float x = static_cast<float>(i % 2), y = static_cast<float>(i / 2 % 2);
              return std::array<float, 4>{cell, 0.25F + 0.5F * x, 0.25F + 0.5F * y, 0};
            });
  const auto lit = [&](std::int32_t x, std::int32_t y) {
    constexpr std::int32_t kEnd = kSide;
    return x >= 0 && y >= 0 && x < kEnd && y < kEnd &&
           !runs[static_cast<std::size_t>(x) + std::size_t{kSide} * static_cast<std::size_t>(y)]
                .stored.empty();
  };
  std::vector<std::uint32_t> cells;
  for (std::uint32_t cell = 0; cell < Emitter::kCells; ++cell) {
    bool near = false;
    for (std::int32_t i = 0; i < 9; ++i) {
      near = near || lit(static_cast<std::int32_t>(cell % kSide) + i % 3 - 1,
                         static_cast<std::int32_t>(cell / kSide) + i / 3 - 1);
    }
    if (near) cells.push_back(cell);
  }
  return {Emitter(whole.light(), reach, std::move(cells)), joined(runs).segments};
}

Shot shoot(const ddgi::RayScene& scene, const Emitter& emitter, std::uint32_t light,
           std::uint32_t number, std::uint16_t generation, const PhotonBatch& former,
           const ShotOptions& options, ddgi::ThreadPool& pool) {
  const std::uint32_t seed = ddgi::hash(options.seed, light), first = number * options.emitted;
  Paths paths = joined(trace(scene, emitter, ddgi::hash(seed, number), options.emitted, 256, pool,
                             [&](std::uint32_t i) { return even_numbers(seed, first + i); }));
  auto& hits = paths.stored;
  float stands_for = 1;
  if (hits.size() > options.capacity) {
    for (std::size_t i = 0; i < options.capacity; ++i) {
      hits[i] = hits[i * hits.size() / options.capacity];
    }
    stands_for = static_cast<float>(hits.size()) / static_cast<float>(options.capacity);
    hits.resize(options.capacity);
  }
  Shot shot;
  shot.paths = std::move(paths.segments);
  shot.batch.watts = emitter.watts();
  shot.batch.light = static_cast<std::uint16_t>(light);
  shot.batch.generation = generation;
  shot.batch.emitted = options.emitted;
  std::vector<Vec3> places;
  ddgi::Box box;
  for (const Hit& hit : hits) {
    places.push_back(hit.position);
    box.add(hit.position);
  }
  if (hits.empty()) return shot;
  box = steady(box_of(former), widened(box, options.largest_radius));
  shot.batch.minimum = position(box.lo);
  shot.batch.extent = position(box.size());
  const auto radii = neighbour_distances(places, options.neighbours, options.largest_radius, pool);
  shot.records.resize(hits.size() * kPhotonBytes);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Photon photon{position(hits[i].position), position(hits[i].direction),
                        position(hits[i].power), round_fraction(radii[i], options.radius_bits),
                        stands_for};
    pack_photon(photon, shot.batch, options.form,
                PhotonBytes(&shot.records[i * kPhotonBytes], kPhotonBytes));
  }
  const VolumeDesc volume = *photon_volume(1, 1, options.form);
  kPhotons.sort(volume.groups.front().textures.back().desc, shot.records);
  return shot;
}

}  // namespace gicodec::photons
