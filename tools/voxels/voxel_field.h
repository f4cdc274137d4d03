// Voxels as they are looked up: the client's way, and the server's for light that bounces.
#pragma once

#include "brick_pool.h"

#include <gicodec/volume.h>

#include <functional>
#include <optional>

namespace gicodec::voxels {

/// Of a block of the texture "bricks"; nothing if its slot is free.
[[nodiscard]] std::optional<BrickPlace> brick_in(std::span<const std::byte> block);

/// The level whose voxels are that wide, between those that there are: 0 is the finest.
[[nodiscard]] float level_of(double width, double size);

/// Which slot has which brick. A texture may say anything: of bricks that stand in the same place
/// the first one counts.
class BrickIndex {
 public:
  struct Entry {
    std::uint64_t place = 0;  ///< level and Morton key
    std::uint32_t slot = 0;
    auto operator<=>(const Entry&) const = default;
  };
  BrickIndex() = default;
  /// Of slots for which `has` says so, or all.
  BrickIndex(std::span<const std::byte> bricks, BrickShape shape,
             const std::function<bool(std::size_t)>& has = {});

  [[nodiscard]] std::optional<std::uint32_t> find(unsigned level, const Cell& brick) const;
  /// Ascending: by level, then by key.
  [[nodiscard]] std::span<const Entry> entries() const { return entries_; }
  [[nodiscard]] static unsigned level(const Entry& entry);
  [[nodiscard]] unsigned coarsest() const { return coarsest_; }  ///< 0 without bricks

 private:
  std::vector<Entry> entries_;
  std::array<std::size_t, kMaxBrickLevel + 2> begin_{};  ///< of each level, and the end
  unsigned coarsest_ = 0;
};

class VoxelField {
 public:
  VoxelField(BrickShape shape, VoxelForm form) : shape_(shape), code_(form) {}

  /// Takes over what is in the textures, of slots for which `has` says so, or of all.
  void assign(const VolumeGeometry& geometry, std::span<const std::byte> bricks,
              std::span<const std::byte> light, const std::function<bool(std::size_t)>& has = {});

  /// Irradiance over π at a place with a unit normal, by voxels about that wide: of three
  /// directions by the normal's signs, with the squares of its coordinates, between the voxels
  /// around that exist and between two levels. Coarser ones stand in for what is not there, and
  /// the mean of the coarsest where there is nothing at all. A direction without any light is one
  /// within a solid: it has no weight.
  [[nodiscard]] Vec3 irradiance(Vec3 position, Vec3 normal, float width) const;
  [[nodiscard]] const BrickIndex& index() const { return index_; }

 private:
  struct Sum {
    std::array<Vec3, 3> color{};
    std::array<float, 3> weight{};
    bool found = false;

    [[nodiscard]] Vec3 along(Vec3 normal) const;
  };
  [[nodiscard]] Sum around(const std::array<double, 3>& place, Vec3 normal, unsigned level) const;
  [[nodiscard]] Vec3 at_or_above(const std::array<double, 3>& place, Vec3 normal,
                                 unsigned level) const;
  void add(Sum& sum, std::size_t voxel, Vec3 normal, float weight) const;
  [[nodiscard]] bool exists(std::uint32_t slot, unsigned bit) const;

  BrickShape shape_;
  VoxelCode code_;
  std::array<double, 3> origin_{};
  double size_ = 1;
  std::vector<std::byte> bricks_, light_;
  BrickIndex index_;
  Voxel coarsest_;  ///< their mean
};

}  // namespace gicodec::voxels
