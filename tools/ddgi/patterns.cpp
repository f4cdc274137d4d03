#include "patterns.h"

#include "noise.h"

namespace gicodec::ddgi {
namespace {

/// Repeating noise over the unit square, with `cells` cells in the first octave.
float tile_noise(float u, float v, std::int32_t cells, int octaves, std::uint32_t seed) {
  const auto n = static_cast<float>(cells);
  return fbm({u * n, v * n, 0}, octaves, cells, seed);
}

}  // namespace

Image bricks(const Bricks& spec, std::uint32_t side) {
  return make_image(side, [&](float u, float v) {
    const float y = v * static_cast<float>(spec.rows);
    const auto row = static_cast<std::uint32_t>(y);
    const float shift = spec.offset && row % 2 ? 0.5F : 0.0F;
    const float x = u * static_cast<float>(spec.columns) + shift;
    const auto column = static_cast<std::uint32_t>(x) % spec.columns;
    const float fx = x - std::floor(x), fy = y - std::floor(y);
    const float edge = std::min(std::min(fx, 1 - fx) / static_cast<float>(spec.columns),
                                std::min(fy, 1 - fy) / static_cast<float>(spec.rows));
    const float shade = 1 + spec.variation * (unit(hash(hash(row, column), spec.seed)) - 0.5F) +
                        0.35F * (tile_noise(u, v, 16, 4, spec.seed) - 0.5F);
    const float stone = smoothstep(spec.joint * 0.5F, spec.joint, edge);
    return lerp(spec.mortar * (0.8F + 0.4F * tile_noise(u, v, 32, 2, spec.seed + 9)),
                spec.colour * shade, stone);
  });
}

Image mottled(Vec3 a, Vec3 b, std::int32_t cells, float contrast, std::uint32_t seed,
              std::uint32_t side) {
  return make_image(side, [=](float u, float v) {
    const float t = tile_noise(u, v, cells, 5, seed);
    return lerp(a, b, saturate(0.5F + (t - 0.5F) * 2 * contrast));
  });
}

Image marble(Vec3 ground, Vec3 vein, std::uint32_t seed, std::uint32_t side) {
  return make_image(side, [=](float u, float v) {
    const float warp = tile_noise(u, v, 4, 5, seed);
    const float line = std::abs(std::sin(2 * kPi * (u + 2 * v + 1.6F * warp)));
    const float t = std::pow(1 - line, 6.0F) * 0.8F;
    return lerp(ground * (0.94F + 0.12F * tile_noise(u, v, 8, 3, seed + 5)), vein, t);
  });
}

Image wood(Vec3 light, Vec3 dark, std::uint32_t seed, std::uint32_t side) {
  return make_image(side, [=](float u, float v) {
    const auto plank = static_cast<std::uint32_t>(v * 6);
    const float joint = v * 6 - std::floor(v * 6);
    const float offset = unit(hash(plank, seed));
    const float grain =
        tile_noise(u + offset, v, 4, 2, seed) * 10 + fbm({u * 4, v * 96, 0}, 2, 4, seed + 3) * 2;
    const float t = 0.5F + 0.5F * std::sin(grain * 3);
    const float gap = smoothstep(0.0F, 0.04F, std::min(joint, 1 - joint));
    return lerp(light, dark, t) * (0.8F + 0.3F * offset) * (0.35F + 0.65F * gap);
  });
}

Image checker(Vec3 a, Vec3 b, std::uint32_t seed, std::uint32_t side) {
  return make_image(side, [=](float u, float v) {
    const bool odd = (u < 0.5F) != (v < 0.5F);
    const float fx = u * 2 - std::floor(u * 2), fy = v * 2 - std::floor(v * 2);
    const float edge = std::min(std::min(fx, 1 - fx), std::min(fy, 1 - fy));
    const float joint = 0.6F + 0.4F * smoothstep(0.005F, 0.02F, edge);
    return (odd ? a : b) * joint * (0.8F + 0.4F * tile_noise(u, v, 8, 4, seed));
  });
}

Image mosaic(Vec3 a, Vec3 b, Vec3 c, std::uint32_t seed, std::uint32_t side) {
  return make_image(side, [=](float u, float v) {
    const float x = u - 0.5F, y = v - 0.5F;
    const float diamond = std::abs(x) + std::abs(y), ring = std::hypot(x, y);
    Vec3 colour = diamond < 0.5F ? a : b;
    if (ring > 0.28F && ring < 0.36F) colour = c;
    if (ring < 0.12F) colour = c;
    const float cx = u * 32, cy = v * 32;
    const float chip =
        unit(hash(hash(static_cast<std::uint32_t>(cx), static_cast<std::uint32_t>(cy)), seed));
    const float fx = cx - std::floor(cx), fy = cy - std::floor(cy);
    const float joint =
        smoothstep(0.02F, 0.15F, std::min(std::min(fx, 1 - fx), std::min(fy, 1 - fy)));
    return colour * (0.75F + 0.4F * chip) * (0.7F + 0.3F * joint);
  });
}

Image roof_tiles(Vec3 colour, std::uint32_t seed, std::uint32_t side) {
  return make_image(side, [=](float u, float v) {
    const float x = u * 8, y = v * 8;
    const float fx = x - std::floor(x), fy = y - std::floor(y);
    const float round = 0.55F + 0.45F * std::sin(kPi * fx);
    const float lip = 0.6F + 0.4F * smoothstep(0.0F, 0.25F, fy);
    const float shade =
        0.75F +
        0.5F * unit(hash(hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)), seed));
    return colour * round * lip * shade * (0.8F + 0.4F * tile_noise(u, v, 16, 3, seed));
  });
}

}  // namespace gicodec::ddgi
