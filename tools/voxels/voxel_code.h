// Light of a voxel from six directions, and how it is kept.
#pragma once

#include "ddgi/vec.h"

#include <gicodec/voxels.h>

#include <array>
#include <cstddef>

namespace gicodec::voxels {

using ddgi::Vec3;

/// The middle of the hemisphere that light of a direction comes from.
using ddgi::axis_of;

struct Voxel {
  std::array<Vec3, kVoxelDirections> color{};   ///< irradiance over π
  std::array<float, kVoxelDirections> cover{};  ///< of halves
};

/// Records of the kind.
class VoxelCode {
 public:
  explicit VoxelCode(VoxelForm form) : halves_(form == VoxelForm::halves) {}
  [[nodiscard]] std::size_t bytes() const { return kVoxelDirections * part(); }
  void store(std::byte* record, const Voxel& light) const;
  /// Of any bits, here and below: finite, and not negative.
  [[nodiscard]] Voxel load(const std::byte* record) const;
  [[nodiscard]] Vec3 color(const std::byte* record, std::size_t direction) const;

 private:
  [[nodiscard]] std::size_t part() const { return halves_ ? 8 : 4; }

  bool halves_;
};

}  // namespace gicodec::voxels
