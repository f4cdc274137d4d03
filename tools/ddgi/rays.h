// Directions of probe rays and how they weigh in each texel.
#pragma once

#include "vec.h"

#include <cstddef>
#include <vector>

namespace gicodec::ddgi {

/// Spherical Fibonacci points.
[[nodiscard]] std::vector<Vec3> fibonacci_directions(std::uint32_t count);
/// One of uniformly distributed rotations, the same for the same numbers.
[[nodiscard]] Affine random_rotation(std::uint32_t seed, std::uint32_t number);

/// Weights of one set of directions, shared by all probes. `irradiance`: ray after ray, one weight
/// for each core texel (cosine), and zeros up to `stride`. `visibility`: texel after texel, the
/// rays that matter (cosine to the power of 50).
struct RaySet {
  struct Tap {
    std::uint32_t ray;
    float weight;
  };
  static constexpr std::size_t kTile = 16;
  std::vector<Vec3> directions;
  std::size_t stride;  ///< a multiple of kTile
  std::vector<float> irradiance;
  std::vector<Tap> visibility;
  std::vector<std::uint32_t> visibility_begin;  ///< first tap of each texel, and the end

  /// Texels of a block's side: of colour and of visibility.
  RaySet(std::vector<Vec3> directions, std::uint32_t color_core, std::uint32_t visibility_core);
};

}  // namespace gicodec::ddgi
