#include "rays.h"

#include "noise.h"
#include "octahedral.h"

namespace gicodec::ddgi {

std::vector<Vec3> fibonacci_directions(std::uint32_t count) {
  constexpr double golden = 0.6180339887498949;
  std::vector<Vec3> directions;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double turn = i * golden;
    const double phi = 2 * 3.14159265358979323846 * (turn - std::floor(turn));
    const double z = 1 - (2.0 * i + 1) / count;
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    directions.push_back({static_cast<float>(r * std::cos(phi)),
                          static_cast<float>(r * std::sin(phi)), static_cast<float>(z)});
  }
  return directions;
}

Affine random_rotation(std::uint32_t seed, std::uint32_t number) {
  Random random(hash(seed, number));
  // Shoemake's uniform unit quaternion.
  const float u = random.next(), a = 2 * kPi * random.next(), b = 2 * kPi * random.next();
  const float s = std::sqrt(1 - u), t = std::sqrt(u);
  return Quat{s * std::sin(a), s * std::cos(a), t * std::sin(b), t * std::cos(b)}.affine();
}

RaySet::RaySet(std::vector<Vec3> directions_in, std::uint32_t color_core,
               std::uint32_t visibility_core)
    : directions(std::move(directions_in)),
      stride((std::size_t{color_core} * color_core + kTile - 1) / kTile * kTile) {
  constexpr float least = 1e-6F;
  std::vector<Vec3> texels;
  for (std::uint32_t y = 0; y < color_core; ++y) {
    for (std::uint32_t x = 0; x < color_core; ++x) {
      texels.push_back(texel_direction(x, y, color_core));
    }
  }
  irradiance.resize(directions.size() * stride);
  float* row = irradiance.data();
  for (const Vec3 ray : directions) {
    for (std::size_t t = 0; t < texels.size(); ++t) row[t] = std::max(0.0F, dot(ray, texels[t]));
    row += stride;
  }
  for (std::uint32_t y = 0; y < visibility_core; ++y) {
    for (std::uint32_t x = 0; x < visibility_core; ++x) {
      const Vec3 texel = texel_direction(x, y, visibility_core);
      visibility_begin.push_back(static_cast<std::uint32_t>(visibility.size()));
      for (std::uint32_t i = 0; i < directions.size(); ++i) {
        const float c1 = std::max(0.0F, dot(directions[i], texel));
        const float c2 = c1 * c1, c4 = c2 * c2, c8 = c4 * c4, c16 = c8 * c8;
        const float c50 = c16 * c16 * c16 * c2;
        if (c50 > least) visibility.push_back({i, c50});
      }
    }
  }
  visibility_begin.push_back(static_cast<std::uint32_t>(visibility.size()));
}

}  // namespace gicodec::ddgi
