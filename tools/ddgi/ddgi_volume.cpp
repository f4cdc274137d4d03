#include "ddgi_volume.h"

#include "probe_rays.h"

namespace gicodec::ddgi {
namespace {

/// Hysteresis of the RTXGI kind: what is stored by a root always moves by at least a code towards a
/// different value, else small differences would never arrive.
float blend(float old, float target, float hysteresis, float least) {
  const float delta = target - old;
  const float step = std::min(std::abs(delta), std::max(least, std::abs(delta) * (1 - hysteresis)));
  return old + std::copysign(step, delta);
}

}  // namespace

struct DdgiVolume::State {
  RayScene& scene;
  VolumeShape shape;
  TraceOptions options;
  ThreadPool& pool;
  ProbeTextures textures;
  ColorTexels color_texels;
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
        textures(shape_in.grid, options_in.forms),
        color_texels(options_in.forms.color, options_in.forms.encoding),
        field(shape_in),
        active(classify_probes(scene_in, shape_in, options_in.backfaces, pool_in)),
        directions(fibonacci_directions(options_in.rays)),
        counts(active.size()) {
    field.set_color(textures);
  }

  void rotate_rays() {
    const Affine rotation = random_rotation(options.seed, turns(options) ? updates : 0);
    std::vector<Vec3> turned;
    for (const Vec3 d : directions) turned.push_back(normalize(rotation.vector(d)));
    ray_set = std::make_unique<RaySet>(std::move(turned), options.forms.color_core,
                                       options.forms.visibility_core);
  }

  [[nodiscard]] std::span<ProbeRay> rays_of(std::size_t i) {
    return std::span(rays).subspan(i * options.rays, options.rays);
  }

  /// Channel by channel, so that more light never gives less: converged mode rests on that.
  [[nodiscard]] Vec3 clamped(Vec3 radiance) const {
    return min(radiance, {options.clamp, options.clamp, options.clamp});
  }
  void clamp(std::span<ProbeRay> some) const {
    for (ProbeRay& ray : some) ray.radiance = clamped(ray.radiance);
  }

  void write_visibility(std::uint32_t probe, std::span<const ProbeRay> mine, float hysteresis) {
    const TextureDesc& desc = textures.visibility_desc;
    const Format format = desc.record.format;
    thread_local std::vector<Vec2> moments;
    moments.resize(record_count(desc.block));
    blend_visibility(*ray_set, mine, shape.distance_cap(), moments);
    thread_local std::vector<std::byte> block;
    block.assign(bytes_of_block(desc), std::byte{});
    if (hysteresis > 0) read_block(desc, textures.visibility, probe, block);
    for (std::uint32_t t = 0; t < moments.size(); ++t) {
      std::byte* texel = core_texel(desc, block, t);
      Vec2 m = moments[t];
      if (hysteresis > 0) {
        const Vec2 old = load_moments(format, texel);
        m = {mix(m.x, old.x, hysteresis), mix(m.y, old.y, hysteresis)};
      }
      store_moments(format, texel, m);
    }
    fill_guard_band(block, side_of(desc), desc.record.bytes);
    write_block(desc, textures.visibility, probe, block);
  }

  /// What is to be stored, of the past and of new light, in the units of the texture.
  [[nodiscard]] Vec3 blended(Vec3 before, Vec3 light, float hysteresis) const {
    const float unit = color_texels.unit();
    const Vec3 old{before.x / unit, before.y / unit, before.z / unit};
    Vec3 target = color_texels.encode(light);
    const Vec3 darker = old - target;
    if (std::max({darker.x, darker.y, darker.z}) > options.irradiance_threshold)
      hysteresis = std::max(0.0F, hysteresis - 0.75F);
    if (length(darker) > options.brightness_threshold) target = old - darker * 0.25F;
    const float least = color_texels.linear() ? 0 : 1 / (unit > 1 ? unit : 1024);
    return {blend(old.x, target.x, hysteresis, least), blend(old.y, target.y, hysteresis, least),
            blend(old.z, target.z, hysteresis, least)};
  }

  /// True if the block is not what it was.
  bool write_color(std::uint32_t probe, std::span<const ProbeRay> mine, float hysteresis) {
    const TextureDesc& desc = textures.color_desc;
    thread_local std::vector<Vec3> irradiance;
    irradiance.resize(record_count(desc.block));
    blend_irradiance(*ray_set, mine, irradiance);
    thread_local std::vector<std::byte> before, block;
    before.resize(bytes_of_block(desc));
    read_block(desc, textures.color, probe, before);
    block = before;
    for (std::uint32_t t = 0; t < irradiance.size(); ++t) {
      std::byte* texel = core_texel(desc, block, t);
      const Vec3 old = color_texels.load(texel), light = irradiance[t];
      color_texels.store(texel, hysteresis > 0 ? blended(old, light, hysteresis)
                                               : color_texels.encode(light, old));
    }
    fill_guard_band(block, side_of(desc), desc.record.bytes);
    if (block == before) return false;
    write_block(desc, textures.color, probe, block);
    return true;
  }

  void write_others(std::uint32_t probe, std::span<const ProbeRay> mine, float hysteresis) {
    if (options.forms.sh != ShForm::none) {
      store_sh(options.forms.sh, project_sh(ray_set->directions, mine), hysteresis, probe,
               textures.sh);
    }
    if (options.forms.light) {
      ProbeLight& light = textures.light[probe];
      light = mix(measure_light(ray_set->directions, mine, sun_at(probe)), light, hysteresis);
    }
  }

  /// 1 where the sun is seen from a probe.
  [[nodiscard]] float sun_at(std::uint32_t probe) const {
    for (const Light& light : scene.state().lights) {
      if (light.type != LightType::sun) continue;
      return scene.occluded(shape.position(probe), -light.direction, 1e30F) ? 0 : 1;
    }
    return 0;
  }

  std::uint32_t update_converged() {
    rays.resize(active.size() * options.rays);
    pool.run(active.size(), [&](std::size_t i) {
      const auto mine = rays_of(i);
      trace_probe(scene, shape.position(active[i]), ray_set->directions, mine, counts[i]);
      clamp(mine);
      write_visibility(active[i], mine, 0);
    });
    field.set_visibility(textures);

    // First bounce: what the rays bring without the volume.
    std::vector<std::uint8_t> changed(shape.probes(), 1);
    pool.run(active.size(), [&](std::size_t i) {
      find_cages(field, ray_set->directions, rays_of(i));
      write_color(active[i], rays_of(i), 0);
      field.set_color(textures, active[i]);
    });
    std::uint32_t bounces = 1;
    while (bounces < options.max_bounces && bounce_again(changed)) ++bounces;
    pool.run(active.size(), [&](std::size_t i) { write_others(active[i], rays_of(i), 0); });
    return bounces;
  }

  /// One more bounce for the rays that end near a probe that has changed.
  bool bounce_again(std::vector<std::uint8_t>& changed) {
    std::vector<std::uint8_t> next(changed.size());
    pool.run(active.size(), [&](std::size_t i) {
      bool any = false;
      for (ProbeRay& ray : rays_of(i)) {
        if (ray.end != RayEnd::front || !near_change(ray.cage, changed)) continue;
        ray.radiance = clamped(bounce(field, ray));
        any = true;
      }
      if (!any) return;
      next[active[i]] = write_color(active[i], rays_of(i), 0);
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
      clamp(mine);
      write_visibility(active[i], mine, hysteresis);
      write_color(active[i], mine, hysteresis);
      write_others(active[i], mine, hysteresis);
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
  if (!s.ray_set || turns(s.options)) s.rotate_rays();
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
