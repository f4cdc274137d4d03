// Weighted sample elimination (Yuksel 2015): of samples on surfaces those stay that are far from
// each other.
#pragma once

#include "ddgi/parallel.h"
#include "ddgi/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::ao {

/// A sample, on one side of a surface.
struct SurfacePoint {
  ddgi::Vec3 position, normal;  ///< the normal interpolated, unit length
  ddgi::Vec3 geometric;         ///< of the triangle, unit length
};

/// r_max: half the distance of `count` samples that fill `area` in a hexagonal pattern.
[[nodiscard]] float largest_radius(double area, double count);

/// The indices, ascending, of the `keep` samples that stay. The one with the greatest sum of
/// weights (1 − d / 2 r_max)^8 goes first, of equal ones the one with the greatest index; samples
/// whose normals are more than 90° apart do not count as neighbours. Precondition: keep is at most
/// their number, r_max is positive, positions are finite.
[[nodiscard]] std::vector<std::uint32_t> eliminate(std::span<const SurfacePoint> samples,
                                                   std::size_t keep, float r_max,
                                                   ddgi::ThreadPool& pool);

}  // namespace gicodec::ao
