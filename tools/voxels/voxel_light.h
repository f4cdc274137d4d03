// Voxels as a client draws with them.
#pragma once

#include "voxel_field.h"

#include "kinds/volume_light.h"

namespace gicodec::voxels {

class VoxelLight final : public kinds::VolumeLight {
 public:
  /// `detail`: pixels that voxels cover at least, where there are coarser ones; 0: the finest are
  /// looked up. Throws tools::Error of Exit::bad_input for a volume of another kind.
  VoxelLight(const VolumeDesc& desc, float detail);

  void update(const kinds::HeldVolume& volume, double time) override;
  void prepare(const ddgi::RayScene& scene, const ddgi::PictureView& view,
               ddgi::ThreadPool& pool) override;
  [[nodiscard]] Vec3 irradiance(const ddgi::SeenSurface& seen) const override;
  [[nodiscard]] const VoxelField& field() const { return field_; }

 private:
  float detail_, pixel_ = 0;  ///< metres per metre of distance
  VolumeDesc own_;
  VoxelField field_;
};

}  // namespace gicodec::voxels
