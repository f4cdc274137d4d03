// Hashes and value noise: the same numbers on every machine.
#pragma once

#include "vec.h"

namespace gicodec::ddgi {

[[nodiscard]] constexpr std::uint32_t hash(std::uint32_t v) {
  v ^= v >> 16, v *= 0x7FEB352DU;
  v ^= v >> 15, v *= 0x846CA68BU;
  return v ^ (v >> 16);
}
[[nodiscard]] constexpr std::uint32_t hash(std::uint32_t a, std::uint32_t b) {
  return hash(a ^ hash(b + 0x9E3779B9U));
}
/// In [0, 1).
[[nodiscard]] constexpr float unit(std::uint32_t h) {
  return static_cast<float>(h >> 8) * (1.0F / 16777216.0F);
}

/// A stream of numbers in [0, 1) for a seed. Never draw two of them in the arguments of one call:
/// compilers differ in which they evaluate first. Lists in braces are evaluated in order.
class Random {
 public:
  explicit constexpr Random(std::uint32_t seed) : seed_(seed) {}
  constexpr float next() { return unit(hash(seed_, count_++)); }
  constexpr float in(float lo, float hi) { return lo + (hi - lo) * next(); }

 private:
  std::uint32_t seed_, count_ = 0;
};

/// Value noise in [0, 1] on the integer lattice, repeating after `period` cells if that is not 0.
[[nodiscard]] inline float noise(Vec3 p, std::int32_t period = 0, std::uint32_t seed = 0) {
  const Vec3 f{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
  const auto wrap = [period](std::int32_t i) {
    return period > 0 ? static_cast<std::uint32_t>(((i % period) + period) % period)
                      : static_cast<std::uint32_t>(i);
  };
  const auto ix = static_cast<std::int32_t>(f.x), iy = static_cast<std::int32_t>(f.y),
             iz = static_cast<std::int32_t>(f.z);
  const auto fade = [](float t) { return t * t * (3 - 2 * t); };
  const float tx = fade(p.x - f.x), ty = fade(p.y - f.y), tz = fade(p.z - f.z);
  float sum = 0;
  for (std::int32_t c = 0; c < 8; ++c) {
    const std::int32_t dx = c & 1, dy = (c >> 1) & 1, dz = c >> 2;
    const std::uint32_t h =
        hash(wrap(ix + dx) ^ hash(wrap(iy + dy) ^ hash(wrap(iz + dz) ^ hash(seed))));
    sum += unit(h) * (dx ? tx : 1 - tx) * (dy ? ty : 1 - ty) * (dz ? tz : 1 - tz);
  }
  return sum;
}

/// Sum of octaves, in [0, 1].
[[nodiscard]] inline float fbm(Vec3 p, int octaves, std::int32_t period = 0,
                               std::uint32_t seed = 0) {
  float sum = 0, weight = 0, amplitude = 1;
  for (int i = 0; i < octaves; ++i) {
    sum += amplitude * noise(p, period, seed + static_cast<std::uint32_t>(i));
    weight += amplitude;
    amplitude *= 0.5F;
    p = p * 2.0F;
    period *= 2;
  }
  return sum / weight;
}

}  // namespace gicodec::ddgi
