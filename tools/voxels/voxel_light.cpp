#include "voxel_light.h"

#include "ddgi/client_renderer.h"
#include "dump/error.h"

namespace gicodec::voxels {
namespace {

const TextureDesc& light_of(const VolumeDesc& desc) {
  if (desc.kind != kKindVoxels || desc.groups.empty() || desc.groups.front().textures.size() != 2) {
    tools::fail(tools::Exit::bad_input, "the volume holds no voxels");
  }
  return desc.groups.front().textures.back().desc;
}

VoxelForm form_of(const VolumeDesc& desc) {
  return tools::take(voxel_form(light_of(desc).record), "voxels");
}

}  // namespace

VoxelLight::VoxelLight(const VolumeDesc& desc, float detail)
    : detail_(detail),
      own_(tools::take(voxel_volume(light_of(desc).grid.x, light_of(desc).block.y, form_of(desc)),
                       "voxels")),
      field_({light_of(desc).block.y}, form_of(desc)) {}

void VoxelLight::update(const kinds::HeldVolume& volume, double /*time*/) {
  kinds::check_held(volume, own_);
  const kinds::HeldTexture &bricks = volume.textures[0], &light = volume.textures[1];
  field_.assign(volume.geometry, bricks.texels, light.texels,
                [&](std::size_t slot) { return bricks.has(slot) && light.has(slot); });
}

void VoxelLight::prepare(const ddgi::RayScene& /*scene*/, const ddgi::PictureView& view,
                         ddgi::ThreadPool& /*pool*/) {
  pixel_ = ddgi::PictureRays(view).spread();
}

Vec3 VoxelLight::irradiance(const ddgi::SeenSurface& seen) const {
  const ddgi::Surface& surface = seen.surface;
  return field_.irradiance(surface.position, surface.normal, surface.distance * pixel_ * detail_);
}

}  // namespace gicodec::voxels
