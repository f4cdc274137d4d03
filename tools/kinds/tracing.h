// Helpers of several kinds' tracers: loops over threads, directions, boxes of moving objects.
#pragma once

#include "ddgi/parallel.h"
#include "ddgi/vec.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace gicodec::kinds {

/// Calls body(index) for every index below `count`, in batches; each batch has one thread.
template <typename Body>
void for_all(std::size_t count, ddgi::ThreadPool& pool, const Body& body) {
  constexpr std::size_t kBatch = 8;  // small, to notice an interrupt soon
  pool.run((count + kBatch - 1) / kBatch, [&](std::size_t batch) {
    const std::size_t end = std::min(count, (batch + 1) * kBatch);
    for (std::size_t i = batch * kBatch; i < end; ++i) body(i);
  });
}

[[nodiscard]] constexpr float coordinate(ddgi::Vec3 v, unsigned axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/// The unit vector at an angle of this cosine to the unit vector `axis`, rotated around it by
/// `turn` of a whole turn.
[[nodiscard]] inline ddgi::Vec3 around(ddgi::Vec3 axis, float cosine, float turn) {
  ddgi::Vec3 u, v;
  ddgi::basis(axis, u, v);
  const float sine = std::sqrt(std::max(0.0F, 1 - cosine * cosine)), phi = 2 * ddgi::kPi * turn;
  return ddgi::normalize(u * (sine * std::cos(phi)) + v * (sine * std::sin(phi)) + axis * cosine);
}

/// A cosine-distributed direction around a unit vector, for numbers in [0, 1).
[[nodiscard]] inline ddgi::Vec3 cosine_direction(ddgi::Vec3 normal, float u, float v) {
  return around(normal, std::sqrt(1 - u), v);
}

/// The box around a transformed box, enlarged by a distance on all sides.
[[nodiscard]] inline ddgi::Box moved(const ddgi::Box& box, const ddgi::Affine& m, float distance) {
  ddgi::Box out;
  for (unsigned i = 0; i < 8; ++i) {
    out.add(m.point(
        {i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z}));
  }
  const ddgi::Vec3 more{distance, distance, distance};
  return {out.lo - more, out.hi + more};
}

}  // namespace gicodec::kinds
