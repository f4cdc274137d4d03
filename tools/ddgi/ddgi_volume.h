// The probe update: rays, shading with one more bounce from the volume itself, blending
// (Majercik et al. 2019, §4).
#pragma once

#include "parallel.h"
#include "probe_field.h"
#include "ray_scene.h"
#include "rays.h"
#include "volume.h"

#include <chrono>
#include <limits>

namespace gicodec::ddgi {

enum class TraceMode : std::uint8_t {
  /// Light bounces, starting from a black volume, until no texel changes any more, so the textures
  /// depend on nothing but the rays and the scene at that time: with fixed rays, what does not
  /// change in the scene repeats bit for bit. Ends always: each bounce can only add light.
  converged,
  /// One bounce per update, blended into what was there.
  noisy,
};

/// Whether the rays turn at every update.
enum class Rotation : std::uint8_t {
  by_mode,  ///< converged: fixed, noisy: turning
  fixed,
  turning,
};

struct TraceOptions {
  TraceMode mode = TraceMode::converged;
  std::uint32_t rays = 256;        ///< per probe, 1..65536
  float hysteresis = 0.97F;        ///< noisy: share of the old value, 0..1
  std::uint32_t seed = 1;          ///< of the rotations
  std::uint32_t max_bounces = 64;  ///< converged: gives up here
  float backfaces = 0.25F;  ///< share of rays that see insides above which a probe is inactive
  Rotation rotation = Rotation::by_mode;
  float clamp = kNoLimit;  ///< of each channel of a ray's radiance
  // noisy, as RTXGI's settings of these names, both in the units of the texture: a channel that
  // falls by more forgets the past by 0.75 sooner; of a change by more a quarter is taken.
  float irradiance_threshold = kNoLimit, brightness_threshold = kNoLimit;
  TextureForms forms = {};

  static constexpr float kNoLimit = std::numeric_limits<float>::infinity();
};

[[nodiscard]] constexpr bool turns(const TraceOptions& options) {
  return options.rotation == Rotation::turning ||
         (options.rotation == Rotation::by_mode && options.mode == TraceMode::noisy);
}

struct UpdateStatistics {
  std::uint64_t probe_rays = 0, shadow_rays = 0;
  std::uint32_t bounces = 0;  ///< until nothing changed (converged)
  double seconds = 0;
};

/// A traced probe volume. One thread at a time; uses the pool's threads. The textures are the same
/// for the same scene, times and options, whatever the number of threads.
class DdgiVolume {
 public:
  /// The scene and the pool must outlive it. Classifies the probes: those inside what never moves
  /// are inactive for good, their blocks zero.
  DdgiVolume(RayScene& scene, const VolumeShape& shape, const TraceOptions& options,
             ThreadPool& pool);
  ~DdgiVolume();
  DdgiVolume(const DdgiVolume&) = delete;
  DdgiVolume& operator=(const DdgiVolume&) = delete;

  /// Puts the scene into its state at `time` and traces the volume anew.
  UpdateStatistics update(double time);
  /// Contents after the last update.
  [[nodiscard]] const ProbeTextures& textures() const noexcept;
  [[nodiscard]] const VolumeShape& shape() const noexcept;
  [[nodiscard]] std::span<const std::uint32_t> active_probes() const noexcept;  ///< ascending

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Indices of the probes that are not inside static geometry, ascending.
[[nodiscard]] std::vector<std::uint32_t> classify_probes(const RayScene& scene,
                                                         const VolumeShape& shape, float backfaces,
                                                         ThreadPool& pool);

}  // namespace gicodec::ddgi
