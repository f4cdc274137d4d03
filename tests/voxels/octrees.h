// Octrees by chance, and what a client holds of them.
#pragma once

#include "../ddgi/rooms.h"

#include "voxels/voxels.h"

#include "ddgi/noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <vector>

namespace gicodec::voxels::test {

inline constexpr std::array kForms{VoxelForm::shared_exponent, VoxelForm::halves};

inline void expect_near(Vec3 value, Vec3 expected, float error) {
  EXPECT_NEAR(value.x, expected.x, error);
  EXPECT_NEAR(value.y, expected.y, error);
  EXPECT_NEAR(value.z, expected.z, error);
}

inline Vec3 random_direction(ddgi::Random& random) {
  Vec3 d;
  do {
    d = {random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)};
  } while (!(dot(d, d) > 0.01F && dot(d, d) <= 1));
  return normalize(d);
}

inline Vec3 random_point(ddgi::Random& random, float lo, float hi) {
  return {random.in(lo, hi), random.in(lo, hi), random.in(lo, hi)};
}

/// Each cell of cells³ is a voxel with this share; no direction is dark.
inline Octree random_octree(std::uint32_t cells, float share, std::uint32_t seed, unsigned side,
                            VoxelForm form) {
  ddgi::Random random(seed);
  std::vector<VoxelKey> leaves{morton_key({seed % cells, 0, cells - 1})};
  for (std::uint32_t i = 0; i < cells * cells * cells; ++i) {
    if (random.next() < share) {
      leaves.push_back(morton_key({i % cells, i / cells % cells, i / cells / cells}));
    }
  }
  std::ranges::sort(leaves);
  leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
  Octree octree = grow(leaves, levels_of({cells, cells, cells}, side));
  const VoxelCode code(form);
  octree[0].records.resize(leaves.size() * code.bytes());
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    Voxel voxel;
    for (std::size_t d = 0; d < kVoxelDirections; ++d) {
      voxel.color[d] = {random.in(0.1F, 2), random.in(0.1F, 2), random.in(0.1F, 2)};
      voxel.cover[d] = random.next();
    }
    code.store(&octree[0].records[i * code.bytes()], voxel);
  }
  pull(octree, code);
  return octree;
}

inline std::uint32_t bricks_in(const Octree& octree, BrickShape shape) {
  std::uint64_t sum = 0;
  for (const std::uint64_t bricks : brick_counts(octree, shape)) sum += bricks;
  return static_cast<std::uint32_t>(sum);
}

inline BrickPool pooled(const Octree& octree, BrickShape shape, VoxelForm form) {
  BrickPool pool(bricks_in(octree, shape) + 5, shape, form);
  static_cast<void>(pool.put(octree));
  return pool;
}

/// Voxels of half a metre from (-2, 1, 0) on.
inline VolumeGeometry geometry(std::uint32_t slots) {
  return {{slots, 1, 1}, {-2, 1, 0}, {0.5F, 0.5F, 0.5F}, {}};
}
inline Vec3 centre_of(const Cell& cell, unsigned level) {
  const auto at = [&](std::uint32_t c) {
    return 0.5F * std::ldexp(static_cast<float>(c) + 0.5F, static_cast<int>(level));
  };
  return Vec3{-2, 1, 0} + Vec3{at(cell[0]), at(cell[1]), at(cell[2])};
}

inline std::optional<BrickPlace> place_in(const BrickPool& pool, std::uint32_t slot) {
  const std::size_t size = pool.shape().place_bytes();
  return brick_in(pool.bricks().subspan(slot * size, size));
}

using Place = std::array<std::uint32_t, 4>;
inline Place key_of(const BrickPlace& place) {
  return {place.level, place.at[0], place.at[1], place.at[2]};
}
/// Each that is in the mask has its parent there.
inline bool is_closed(const BrickPool& pool, std::span<const std::uint8_t> mask, unsigned top) {
  std::set<Place> in;
  for (std::uint32_t slot = 0; slot < pool.slots(); ++slot) {
    if (mask[slot] != 0) in.insert(key_of(*place_in(pool, slot)));
  }
  return std::ranges::all_of(in, [&](const Place& p) {
    return p[0] == top || in.contains({p[0] + 1, p[1] / 2, p[2] / 2, p[3] / 2});
  });
}

/// A volume as a client holds it.
struct Held {
  VolumeDesc desc;
  VolumeGeometry geometry;
  std::vector<std::byte> bricks, light;
  std::vector<std::uint8_t> received{};  ///< empty: all

  Held(const BrickPool& pool, VoxelForm form, const VolumeGeometry& geometry_in)
      : desc(*voxel_volume(pool.slots(), static_cast<std::uint8_t>(pool.shape().side), form)),
        geometry(geometry_in),
        bricks(pool.bricks().begin(), pool.bricks().end()),
        light(pool.light().begin(), pool.light().end()) {}

  void show(VoxelLight& to) const {
    const auto& textures = desc.groups[0].textures;
    const std::array held{kinds::HeldTexture{"bricks", textures[0].desc, bricks, received},
                          kinds::HeldTexture{"light", textures[1].desc, light, received}};
    to.update({desc, geometry, held}, 0);
  }
};

}  // namespace gicodec::voxels::test
