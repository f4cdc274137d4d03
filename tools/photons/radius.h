// How far it is from each photon of a batch to its neighbours.
#pragma once

#include "ddgi/parallel.h"
#include "ddgi/vec.h"

#include <span>
#include <vector>

namespace gicodec::photons {

/// For each point the distance to the `neighbours`-th nearest other one; `most` where it is farther
/// or there are fewer.
[[nodiscard]] std::vector<float> neighbour_distances(std::span<const ddgi::Vec3> points,
                                                     std::uint32_t neighbours, float most,
                                                     ddgi::ThreadPool& pool);

/// Rounded to so many bits behind the leading one, to the nearest.
[[nodiscard]] float round_fraction(float value, std::uint32_t bits);

}  // namespace gicodec::photons
