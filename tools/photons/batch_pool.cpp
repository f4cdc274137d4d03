#include "batch_pool.h"

#include "kinds/tracing.h"

#include <algorithm>

namespace gicodec::photons {
namespace {

using ddgi::Box;
using ddgi::Light;
using ddgi::Vec3;

constexpr float kRounding = 1e-3F;       // metres by which rays may miss where surfaces are
constexpr float kLargestRadius = 0.05F;  // of photons, by that of the sphere around the scene

bool same(const Light& a, const Light& b) {
  return a.type == b.type && a.colour == b.colour && a.position == b.position &&
         a.direction == b.direction && a.cos_inner == b.cos_inner && a.cos_outer == b.cos_outer &&
         a.half_u == b.half_u && a.half_v == b.half_v;
}

Box box_of(const ddgi::Scene& scene, const ddgi::Object& object) {
  Box box;
  if (!object.dynamic) return box;
  for (const std::uint32_t mesh : object.meshes) {
    for (const Vec3 p : scene.meshes[mesh].positions) box.add(p);
  }
  return box;
}

bool any_inside(std::span<const Segment> paths, std::span<const Box> boxes) {
  return std::any_of(boxes.begin(), boxes.end(),
                     [&](const Box& box) { return any_inside(paths, box); });
}

}  // namespace

BatchPool::BatchPool(const ddgi::RayScene& scene, const PoolOptions& options)
    : scene_(scene),
      options_(options),
      reach_(sphere_around(scene.scene().bounds())),
      transforms_(scene.state().transforms),
      slots_(options.batches) {
  options_.shots.largest_radius = kLargestRadius * reach_.radius;
  for (const ddgi::Object& object : scene.scene().objects) {
    boxes_.push_back(box_of(scene.scene(), object));
  }
}

/// What objects that moved have left and entered.
std::vector<Box> BatchPool::find_touched() {
  const auto& transforms = scene_.state().transforms;
  std::vector<Box> touched;
  for (std::size_t i = 0; i < transforms.size(); ++i) {
    if (boxes_[i].empty() || transforms[i] == transforms_[i]) continue;
    touched.push_back(kinds::moved(boxes_[i], transforms_[i], kRounding));
    touched.push_back(kinds::moved(boxes_[i], transforms[i], kRounding));
  }
  transforms_ = transforms;
  return touched;
}

void BatchPool::look_at_lights(std::span<const Box> touched, ddgi::ThreadPool& pool) {
  const auto& lights = scene_.state().lights;
  lights_.resize(lights.size());
  for (std::uint32_t i = 0; i < lights.size(); ++i) {
    Known& known = lights_[i];
    if (!known.known || !same(known.state, lights[i])) ++known.generation;
    Projection& projection = known.projection;
    const auto& cells = projection.emitter.cells();
    Emitter as_before(lights[i], reach_, {cells.begin(), cells.end()});
    if (same_photons(as_before, projection.emitter) && !any_inside(projection.paths, touched)) {
      projection.emitter = std::move(as_before);
    } else {
      projection = project(scene_, reach_, i, options_.shots.seed, pool);
    }
    known.state = lights[i];
    known.known = true;
  }
}

/// How many batches each light has, and how many all would have without a limit. Those with most
/// lose what is too much; of lights with one batch each the last ones go without.
std::uint64_t BatchPool::share_out() {
  std::uint64_t wanted = 0, given = 0;
  for (Known& known : lights_) {
    const double photons = double{known.projection.emitter.watts()} * options_.per_watt;
    const double batches = photons > 0 ? std::ceil(photons / options_.shots.emitted) : 0;
    const auto whole = static_cast<std::uint64_t>(std::min(batches, 1e9));
    known.batches = static_cast<std::uint32_t>(std::min<std::uint64_t>(whole, slots_.size()));
    wanted += whole;
    given += known.batches;
  }
  for (; given > slots_.size(); --given) {
    Known* most = &lights_.front();
    for (Known& known : lights_) {
      if (known.batches >= most->batches) most = &known;
    }
    --most->batches;
  }
  return wanted;
}

/// Frees the slots of batches that are no more, and gives new ones a slot each.
void BatchPool::assign(Update& update) {
  std::vector<std::uint32_t> free;
  std::vector<std::vector<bool>> has;
  for (const Known& known : lights_) has.emplace_back(known.batches);
  for (std::uint32_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    if (slot.used && slot.light < has.size() && slot.number < has[slot.light].size()) {
      has[slot.light][slot.number] = true;
      continue;
    }
    if (slot.used) update.changed.push_back(i);
    slot = {};
    free.push_back(i);
  }
  auto next = free.begin();
  for (std::uint32_t light = 0; light < has.size(); ++light) {
    for (std::uint32_t number = 0; number < has[light].size(); ++number) {
      if (has[light][number]) continue;
      Slot& slot = slots_[*next++];
      slot.light = light;
      slot.number = number;
      slot.used = slot.stale = true;
      slot.stale_since = updates_;
    }
  }
}

void BatchPool::find_stale(std::span<const Box> touched, Update& update) {
  for (std::uint32_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    if (!slot.used || slot.shot.batch.emitted == 0) continue;
    const Known& light = lights_[slot.light];
    const bool same = same_photons(slot.emitter, light.projection.emitter);
    if (same && slot.shot.batch.generation != light.generation) {
      slot.shot.batch.watts = light.projection.emitter.watts();
      slot.shot.batch.generation = light.generation;
      update.changed.push_back(i);
    }
    if (slot.stale || (same && !any_inside(slot.shot.paths, touched))) continue;
    slot.stale = true;
    slot.stale_since = updates_;
  }
}

BatchPool::Update BatchPool::update(ddgi::ThreadPool& pool) {
  Update update;
  ++updates_;
  const std::vector<Box> touched = find_touched();
  look_at_lights(touched, pool);
  update.wanted = share_out();
  assign(update);
  find_stale(touched, update);
  std::vector<std::uint32_t> stale;
  for (std::uint32_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i].stale) stale.push_back(i);
  }
  std::stable_sort(stale.begin(), stale.end(), [&](std::uint32_t a, std::uint32_t b) {
    return slots_[a].stale_since < slots_[b].stale_since;
  });
  if (options_.per_update != 0 && stale.size() > options_.per_update) {
    update.stale = static_cast<std::uint32_t>(stale.size()) - options_.per_update;
    stale.resize(options_.per_update);
  }
  for (const std::uint32_t i : stale) {
    Slot& slot = slots_[i];
    const Known& light = lights_[slot.light];
    slot.emitter = light.projection.emitter;
    slot.shot = shoot(scene_, slot.emitter, slot.light, slot.number, light.generation,
                      slot.shot.batch, options_.shots, pool);
    slot.stale = false;
  }
  update.shot = static_cast<std::uint32_t>(stale.size());
  update.changed.insert(update.changed.end(), stale.begin(), stale.end());
  std::sort(update.changed.begin(), update.changed.end());
  update.changed.erase(std::unique(update.changed.begin(), update.changed.end()),
                       update.changed.end());
  return update;
}

}  // namespace gicodec::photons
