// Shoots a batch of photons from one light (Crassin et al. §4.3; Jensen 2001).
#pragma once

#include "emission.h"

#include "ddgi/parallel.h"
#include "ddgi/ray_scene.h"

#include <gicodec/photons.h>

#include <vector>

namespace gicodec::photons {

struct ShotOptions {
  std::uint32_t emitted = 16384;   ///< photons that leave the light
  std::uint32_t capacity = 32768;  ///< stored ones at most
  std::uint32_t neighbours = 10;   ///< the radius reaches as many other photons of the batch
  std::uint32_t radius_bits = 3;   ///< of the fraction of the radius as a half, 0..10
  PhotonForm form = PhotonForm::halves;
  std::uint32_t seed = 1;
  float largest_radius = 1;  ///< metres; boxes of batches are widened to about as large steps
};

/// A piece of a photon's path, up to where it met a surface or left the scene.
struct Segment {
  ddgi::Vec3 from, to;
};
/// Whether any of them comes into the box.
[[nodiscard]] bool any_inside(std::span<const Segment> segments, const ddgi::Box& box);

struct Shot {
  PhotonBatch batch;
  std::vector<std::byte> records;  ///< kPhotonBytes each, in the kind's canonical order
  std::vector<Segment> paths;      ///< of all photons, stored or not
};

/// A light of the scene, in the state that the scene is in.
struct Projection {
  Emitter emitter;
  std::vector<Segment> paths;  ///< of what was shot to find its cells
};
/// A sun's cells are those through which some of a few paths were stored, and the cells around
/// them: what comes through gaps that are smaller than cells may be missed.
[[nodiscard]] Projection project(const ddgi::RayScene& scene, const Sphere& reach,
                                 std::uint32_t light, std::uint32_t seed, ddgi::ThreadPool& pool);

/// Batch `number` of light `light`, whose emitter must have watts. The same numbers, emitter and
/// surfaces give the same photons, whatever the number of threads, in the box of `former`, which
/// the slot had before, if they fit into it. Photons are stored where they
/// met a surface, but for the first one: direct light is drawn by the client. They go on with the
/// probability of the largest channel of the albedo. Of more than there is room for, an even choice
/// is stored, and normalised for the rest.
[[nodiscard]] Shot shoot(const ddgi::RayScene& scene, const Emitter& emitter, std::uint32_t light,
                         std::uint32_t number, std::uint16_t generation, const PhotonBatch& former,
                         const ShotOptions& options, ddgi::ThreadPool& pool);

}  // namespace gicodec::photons
