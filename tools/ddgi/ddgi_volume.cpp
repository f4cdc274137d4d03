#include "ddgi_volume.h"

#include "probe_rays.h"

#include <atomic>

namespace gicodec::ddgi {
namespace {

constexpr std::uint32_t kColorTexels = kIrradianceSide * kIrradianceSide;
constexpr std::uint32_t kVisibilityTexels = kVisibilitySide * kVisibilitySide;
using ColorBlock = std::array<std::uint32_t, kColorTexels>;
using VisibilityBlock = std::array<std::uint32_t, kVisibilityTexels>;

std::uint32_t core_texel(std::uint32_t t, std::uint32_t core) {
  return (t / core + 1) * (core + 2) + t % core + 1;
}

/// Hysteresis of the RTXGI kind: a code always moves by at least one towards a different value,
/// else small differences would never arrive.
std::uint32_t blend_code(std::uint32_t old_code, float target, float hysteresis) {
  const float old = static_cast<float>(old_code) / 1023.0F;
  const float delta = target - old;
  const float step =
      std::min(std::abs(delta), std::max(1 / 1023.0F, std::abs(delta) * (1 - hysteresis)));
  const float blended = saturate(old + std::copysign(step, delta)) * 1023.0F;
  return static_cast<std::uint32_t>(std::floor(blended + 0.5F));
}

}  // namespace

struct DdgiVolume::State {
  RayScene& scene;
  VolumeShape shape;
  TraceOptions options;
  ThreadPool& pool;
  ProbeTextures textures;
  ProbeField field;
  std::vector<std::uint32_t> active;
  std::uint32_t updates = 0;

  std::vector<Vec3> directions;     ///< not rotated
  std::unique_ptr<RaySet> ray_set;  ///< of this update
  std::vector<ProbeRay> rays;       ///< converged: of all active probes
  std::vector<RayCount> counts;

  State(RayScene& scene_in, const VolumeShape& shape_in, const TraceOptions& options_in,
        ThreadPool& pool_in)
      : scene(scene_in),
        shape(shape_in),
        options(options_in),
        pool(pool_in),
        textures(shape_in.grid),
        field(shape_in),
        active(classify_probes(scene_in, shape_in, options_in.backfaces, pool_in)),
        directions(fibonacci_directions(options_in.rays)),
        counts(active.size()) {}

  void rotate_rays() {
    const Affine rotation =
        random_rotation(options.seed, options.mode == TraceMode::noisy ? updates : 0);
    std::vector<Vec3> turned;
    for (const Vec3 d : directions) turned.push_back(normalize(rotation.vector(d)));
    ray_set = std::make_unique<RaySet>(std::move(turned));
  }

  [[nodiscard]] std::span<ProbeRay> rays_of(std::size_t i) {
    return std::span(rays).subspan(i * options.rays, options.rays);
  }

  void write_visibility(std::uint32_t probe, const MomentBlock& moments, float hysteresis) {
    VisibilityBlock block{};
    if (hysteresis > 0) read_block(textures.visibility_desc, textures.visibility, probe, block);
    for (std::uint32_t t = 0; t < moments.size(); ++t) {
      std::uint32_t& texel = block[core_texel(t, kVisibilityCore)];
      Vec2 m = moments[t];
      if (hysteresis > 0) {
        const Vec2 old = unpack_moments(texel);
        m = {mix(m.x, old.x, hysteresis), mix(m.y, old.y, hysteresis)};
      }
      texel = pack_moments(m.x, m.y);
    }
    fill_guard_band(block, kVisibilitySide);
    write_block(textures.visibility_desc, textures.visibility, probe, block);
  }

  /// True if the block is not what it was.
  bool write_color(std::uint32_t probe, const IrradianceBlock& irradiance, float hysteresis) {
    ColorBlock before{};
    read_block(textures.color_desc, textures.color, probe, before);
    ColorBlock block = before;
    for (std::uint32_t t = 0; t < irradiance.size(); ++t) {
      std::uint32_t& texel = block[core_texel(t, kIrradianceCore)];
      const auto code = [&](unsigned shift, float value) {
        return hysteresis > 0 ? blend_code(texel >> shift & 1023U, fifth_root(value), hysteresis)
                              : encode_gamma5(value, texel >> shift & 1023U);
      };
      const Vec3 c = irradiance[t];
      texel = pack_color(code(20, c.x), code(10, c.y), code(0, c.z));
    }
    fill_guard_band(block, kIrradianceSide);
    if (block == before) return false;
    write_block(textures.color_desc, textures.color, probe, block);
    return true;
  }

  std::uint32_t update_converged() {
    rays.resize(active.size() * options.rays);
    pool.run(active.size(), [&](std::size_t i) {
      const auto mine = rays_of(i);
      trace_probe(scene, shape.position(active[i]), ray_set->directions, mine, counts[i]);
      MomentBlock moments;
      blend_visibility(*ray_set, mine, shape.distance_cap(), moments);
      write_visibility(active[i], moments, 0);
    });
    field.set_visibility(textures);

    // First bounce: what the rays bring without the volume.
    std::vector<std::uint8_t> changed(shape.probes(), 1);
    pool.run(active.size(), [&](std::size_t i) {
      find_cages(field, ray_set->directions, rays_of(i));
      IrradianceBlock irradiance;
      blend_irradiance(*ray_set, rays_of(i), irradiance);
      write_color(active[i], irradiance, 0);
      field.set_color(textures, active[i]);
    });
    for (std::uint32_t bounces = 1; bounces < options.max_bounces; ++bounces) {
      if (!bounce_again(changed)) return bounces;
    }
    return options.max_bounces;
  }

  /// One more bounce for the rays that end near a probe that has changed.
  bool bounce_again(std::vector<std::uint8_t>& changed) {
    std::vector<std::uint8_t> next(changed.size());
    pool.run(active.size(), [&](std::size_t i) {
      bool any = false;
      for (ProbeRay& ray : rays_of(i)) {
        if (ray.end != RayEnd::front || !near_change(ray.cage, changed)) continue;
        ray.radiance = bounce(field, ray);
        any = true;
      }
      if (!any) return;
      IrradianceBlock irradiance;
      blend_irradiance(*ray_set, rays_of(i), irradiance);
      next[active[i]] = write_color(active[i], irradiance, 0);
    });
    bool any = false;
    for (const std::uint32_t probe : active) {
      if (!next[probe]) continue;
      field.set_color(textures, probe);
      any = true;
    }
    changed = std::move(next);
    return any;
  }

  static bool near_change(const Cage& cage, const std::vector<std::uint8_t>& changed) {
    for (unsigned corner = 0; corner < 8; ++corner) {
      if (cage.weight[corner] > 0 && changed[cage.probe(corner)]) return true;
    }
    return false;
  }

  std::uint32_t update_noisy() {
    // A running mean at first, so that a young volume is no darker than an old one.
    const float age = static_cast<float>(updates);
    const float hysteresis = std::min(options.hysteresis, age / (age + 1));
    pool.run(active.size(), [&](std::size_t i) {
      thread_local std::vector<ProbeRay> mine;
      mine.resize(options.rays);
      trace_probe(scene, shape.position(active[i]), ray_set->directions, mine, counts[i]);
      if (updates > 0) {
        find_cages(field, ray_set->directions, mine);
        for (ProbeRay& ray : mine) {
          if (ray.end == RayEnd::front) ray.radiance = bounce(field, ray);
        }
      }
      MomentBlock moments;
      blend_visibility(*ray_set, mine, shape.distance_cap(), moments);
      write_visibility(active[i], moments, hysteresis);
      IrradianceBlock irradiance;
      blend_irradiance(*ray_set, mine, irradiance);
      write_color(active[i], irradiance, hysteresis);
    });
    field.set_visibility(textures);
    field.set_color(textures);
    return 1;
  }
};

DdgiVolume::DdgiVolume(RayScene& scene, const VolumeShape& shape, const TraceOptions& options,
                       ThreadPool& pool)
    : state_(std::make_unique<State>(scene, shape, options, pool)) {}

DdgiVolume::~DdgiVolume() = default;

UpdateStatistics DdgiVolume::update(double time) {
  State& s = *state_;
  const auto start = std::chrono::steady_clock::now();
  s.scene.set_state(s.scene.scene().state_at(time));
  if (!s.ray_set || s.options.mode == TraceMode::noisy) s.rotate_rays();
  std::fill(s.counts.begin(), s.counts.end(), RayCount{});
  UpdateStatistics statistics;
  statistics.bounces =
      s.options.mode == TraceMode::converged ? s.update_converged() : s.update_noisy();
  ++s.updates;
  for (const RayCount& count : s.counts) {
    statistics.probe_rays += count.probe;
    statistics.shadow_rays += count.shadow;
  }
  statistics.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return statistics;
}

const ProbeTextures& DdgiVolume::textures() const noexcept { return state_->textures; }
const VolumeShape& DdgiVolume::shape() const noexcept { return state_->shape; }
std::span<const std::uint32_t> DdgiVolume::active_probes() const noexcept { return state_->active; }

}  // namespace gicodec::ddgi
