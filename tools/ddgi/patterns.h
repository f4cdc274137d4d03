// Procedural albedo images; all repeat seamlessly.
#pragma once

#include "image.h"

namespace gicodec::ddgi {

/// Courses of bricks or dressed stones, each of its own shade, with mortar between.
struct Bricks {
  Vec3 colour{0.5F, 0.45F, 0.4F}, mortar{0.3F, 0.28F, 0.25F};
  std::uint32_t columns = 4, rows = 8;
  float joint = 0.02F;     ///< width of mortar in uv
  float variation = 0.3F;  ///< of shade between bricks
  bool offset = true;      ///< every other course by half a brick
  std::uint32_t seed = 1;
};
[[nodiscard]] Image bricks(const Bricks& spec, std::uint32_t side = 256);

/// Two colours mixed by noise; `contrast` > 1 sharpens the border between them.
[[nodiscard]] Image mottled(Vec3 a, Vec3 b, std::int32_t cells, float contrast, std::uint32_t seed,
                            std::uint32_t side = 256);
[[nodiscard]] Image marble(Vec3 ground, Vec3 vein, std::uint32_t seed, std::uint32_t side = 256);
[[nodiscard]] Image wood(Vec3 light, Vec3 dark, std::uint32_t seed, std::uint32_t side = 256);
/// Checkerboard of 2 × 2 tiles, each mottled.
[[nodiscard]] Image checker(Vec3 a, Vec3 b, std::uint32_t seed, std::uint32_t side = 256);
/// A mosaic band: rings and diamonds in three colours.
[[nodiscard]] Image mosaic(Vec3 a, Vec3 b, Vec3 c, std::uint32_t seed, std::uint32_t side = 256);
/// Overlapping roof tiles.
[[nodiscard]] Image roof_tiles(Vec3 colour, std::uint32_t seed, std::uint32_t side = 256);

}  // namespace gicodec::ddgi
