// Light of a voxel from six directions, and how it is kept.
#pragma once

#include "ddgi/vec.h"

#include <gicodec/voxels.h>

#include <array>
#include <cstddef>

namespace gicodec::voxels {

using ddgi::Vec3;

/// The middle of the hemisphere that light of a direction comes from: +x, −x, +y, −y, +z, −z.
[[nodiscard]] constexpr Vec3 axis_of(std::size_t direction) {
  const float sign = direction % 2 == 0 ? 1.0F : -1.0F;
  return direction < 2 ? Vec3{sign, 0, 0} : direction < 4 ? Vec3{0, sign, 0} : Vec3{0, 0, sign};
}

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
