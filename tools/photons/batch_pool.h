// The batches of all lights of a scene: which there are, which are stale, which are shot next.
#pragma once

#include "photon_tracer.h"

namespace gicodec::photons {

struct PoolOptions {
  ShotOptions shots;
  float per_watt = 20;           ///< photons that a light sends out, rounded up to whole batches
  std::uint32_t batches = 32;    ///< slots
  std::uint32_t per_update = 4;  ///< batches shot in one update; 0: all that are stale
};

/// A batch for each slot. Between updates one that is not stale is what would be shot now.
class BatchPool {
 public:
  struct Slot {
    std::uint32_t light = 0, number = 0;  ///< its light, and its number there
    bool used = false, stale = false;
    std::uint64_t stale_since = 0;  ///< update
    Emitter emitter;                ///< by which it was shot
    Shot shot;                      ///< nothing before the first one
  };
  struct Update {
    std::vector<std::uint32_t> changed;  ///< slots, ascending
    std::uint32_t shot = 0, stale = 0;   ///< batches shot, and left for later updates
    std::uint64_t wanted = 0;            ///< batches by watts, with those that there is no room for
  };

  /// The scene must outlive it.
  BatchPool(const ddgi::RayScene& scene, const PoolOptions& options);

  /// After the scene has got another state: batches of lights that changed, and those with a path
  /// through what a moved object left or entered, become stale; the oldest stale ones are shot.
  /// Those of lights that only grew or faded get the new watts.
  Update update(ddgi::ThreadPool& pool);
  [[nodiscard]] std::span<const Slot> slots() const noexcept { return slots_; }
  /// With the radius that the scene allows.
  [[nodiscard]] const ShotOptions& shots() const noexcept { return options_.shots; }

 private:
  struct Known {
    bool known = false;
    ddgi::Light state;
    Projection projection;
    std::uint16_t generation = 0;
    std::uint32_t batches = 0;
  };
  [[nodiscard]] std::vector<ddgi::Box> find_touched();
  void look_at_lights(std::span<const ddgi::Box> touched, ddgi::ThreadPool& pool);
  std::uint64_t share_out();
  void assign(Update& update);
  void find_stale(std::span<const ddgi::Box> touched, Update& update);

  const ddgi::RayScene& scene_;
  PoolOptions options_;
  Sphere reach_;
  std::vector<ddgi::Box> boxes_;          ///< of objects, in their own space; empty: never moves
  std::vector<ddgi::Affine> transforms_;  ///< at the last update
  std::vector<Known> lights_;
  std::vector<Slot> slots_;
  std::uint64_t updates_ = 0;
};

}  // namespace gicodec::photons
