#include "vectors.h"

#include "probe_rays.h"
#include "texels.h"

#include <gicodec/irradiance_vectors.h>

#include <array>
#include <cstring>

namespace gicodec::ddgi {
namespace {

constexpr std::size_t kHemispheres = 6;  // +x, -x, +y, -y, +z, -z

/// The vectors of red, green and blue.
using Vectors = std::array<Vec3, 3>;

std::array<Vectors, kHemispheres> integrate(std::span<const Vec3> directions,
                                            std::span<const ProbeRay> rays) {
  std::array<Vectors, kHemispheres> sum{};
  float count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays[i].end == RayEnd::back) continue;
    const Vec3 d = directions[i], c = rays[i].radiance;
    ++count;
    for (const std::size_t h : {d.x > 0 ? std::size_t{0} : 1, d.y > 0 ? std::size_t{2} : 3,
                                d.z > 0 ? std::size_t{4} : 5}) {
      sum[h][0] += d * c.x;
      sum[h][1] += d * c.y;
      sum[h][2] += d * c.z;
    }
  }
  for (Vectors& of_hemisphere : sum) {
    for (Vec3& v : of_hemisphere) v = v * (count > 0 ? 4 / count : 0);
  }
  return sum;
}

/// One texel of each texture.
struct Texel {
  Vec3 direction, color;
};

Texel texel_of(const Vectors& v) {
  const Vec3 d = normalize(v[0] + v[1] + v[2]);
  return {
      d,
      {std::max(0.0F, dot(v[0], d)), std::max(0.0F, dot(v[1], d)), std::max(0.0F, dot(v[2], d))}};
}

std::byte snorm(float value) {
  const float code = std::floor(std::clamp(value, -1.0F, 1.0F) * 127.0F + 0.5F);
  return static_cast<std::byte>(static_cast<std::int8_t>(code));
}

struct Place {
  std::byte *direction, *color;
  bool floats;
};

Texel load(const Place& at) {
  Texel texel;
  if (at.floats) {
    std::memcpy(&texel.direction, at.direction, sizeof texel.direction);
    std::memcpy(&texel.color, at.color, sizeof texel.color);
    return texel;
  }
  const auto axis = [&](std::size_t i) {
    return static_cast<float>(static_cast<std::int8_t>(at.direction[i]));
  };
  std::uint32_t bits = 0;
  std::memcpy(&bits, at.color, sizeof bits);
  return {normalize({axis(0), axis(1), axis(2)}), from_shared_exponent(bits)};
}

void store(const Place& at, const Texel& texel) {
  if (at.floats) {
    std::memcpy(at.direction, &texel.direction, sizeof texel.direction);
    std::memcpy(at.color, &texel.color, sizeof texel.color);
    return;
  }
  at.direction[0] = snorm(texel.direction.x);
  at.direction[1] = snorm(texel.direction.y);
  at.direction[2] = snorm(texel.direction.z);
  const std::uint32_t bits = to_shared_exponent(texel.color);
  std::memcpy(at.color, &bits, sizeof bits);
}

}  // namespace

std::string_view to_string(VectorForm form) noexcept {
  switch (form) {
    case VectorForm::none:
      return "none";
    case VectorForm::quantised:
      return "quantised";
    case VectorForm::floats:
      return "floats";
  }
  return {};
}

VectorTextures vector_textures(VectorForm form, Grid grid) {
  if (form == VectorForm::none) return {};
  const auto volume = irradiance_vector_volume(grid, form == VectorForm::floats);
  if (!volume) return {};
  const auto& textures = volume->sets.front().textures;
  return {*volume, std::vector<std::byte>(texture_bytes(textures[0].desc)),
          std::vector<std::byte>(texture_bytes(textures[1].desc))};
}

void store_vectors(std::span<const Vec3> directions, std::span<const ProbeRay> rays,
                   float hysteresis, std::uint32_t probe, VectorTextures& textures) {
  if (textures.volume.sets.empty()) return;
  const auto& set = textures.volume.sets.front().textures;
  const Record &direction = set[0].desc.record, &color = set[1].desc.record;
  const auto light = integrate(directions, rays);
  for (std::size_t h = 0; h < kHemispheres; ++h) {
    const std::size_t at = probe * kHemispheres + h;
    const Place place{&textures.direction[at * direction.bytes], &textures.color[at * color.bytes],
                      direction.format == Format::R32G32B32_SFLOAT};
    Vectors v = light[h];
    if (hysteresis > 0) {
      const Texel old = load(place);
      const std::array<float, 3> of_old{old.color.x, old.color.y, old.color.z};
      for (std::size_t c = 0; c < v.size(); ++c)
        v[c] = lerp(v[c], old.direction * of_old[c], hysteresis);
    }
    store(place, texel_of(v));
  }
}

}  // namespace gicodec::ddgi
