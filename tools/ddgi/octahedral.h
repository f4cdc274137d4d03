// Octahedral map between unit directions and the square [-1, 1]² (Majercik et al. 2019).
#pragma once

#include "vec.h"

namespace gicodec::ddgi {

[[nodiscard]] inline Vec2 octahedral_encode(Vec3 d) {
  const float l1 = 1.0F / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
  const Vec2 p{d.x * l1, d.y * l1};
  if (d.z >= 0) return p;
  return {std::copysign(1 - std::abs(p.y), p.x), std::copysign(1 - std::abs(p.x), p.y)};
}

[[nodiscard]] inline Vec3 octahedral_decode(Vec2 p) {
  Vec3 d{p.x, p.y, 1 - std::abs(p.x) - std::abs(p.y)};
  if (d.z < 0) {
    const Vec2 q = p;
    d.x = std::copysign(1 - std::abs(q.y), q.x);
    d.y = std::copysign(1 - std::abs(q.x), q.y);
  }
  return normalize(d);
}

/// Direction through the centre of core texel (x, y) of a block of core × core.
[[nodiscard]] inline Vec3 texel_direction(std::uint32_t x, std::uint32_t y, std::uint32_t core) {
  const float scale = 2.0F / static_cast<float>(core);
  return octahedral_decode(
      {(static_cast<float>(x) + 0.5F) * scale - 1, (static_cast<float>(y) + 0.5F) * scale - 1});
}

/// Where a bilinear fetch in direction d reads a block with a guard band of one texel: texels
/// (x, y) to (x+1, y+1), counted with the guard band, and the fractions between them.
struct Fetch {
  std::uint32_t x = 0, y = 0;
  float fx = 0, fy = 0;
};
[[nodiscard]] inline Fetch bilinear_fetch(Vec3 d, std::uint32_t core) {
  const Vec2 p = octahedral_encode(d);
  const float half = static_cast<float>(core) * 0.5F;
  const float u = (p.x + 1) * half + 0.5F, v = (p.y + 1) * half + 0.5F;
  const auto last = static_cast<float>(core);
  const float x = std::clamp(std::floor(u), 0.0F, last), y = std::clamp(std::floor(v), 0.0F, last);
  return {static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), u - x, v - y};
}

}  // namespace gicodec::ddgi
