#include "vector_light.h"

#include "push_pull.h"

#include "dump/error.h"

#include <gicodec/irradiance_vectors.h>

#include <algorithm>

namespace gicodec::vectors {
namespace {

const TextureDesc& texture_of(const VolumeDesc& desc) {
  if (desc.kind != kKindIrradianceVectors || desc.groups.empty() ||
      desc.groups.front().textures.empty()) {
    tools::fail(tools::Exit::bad_input, "the volume holds no irradiance vectors");
  }
  return desc.groups.front().textures.front().desc;
}

bool is_floats(const VolumeDesc& desc) {
  return texture_of(desc).record == colored_direction(true);
}

}  // namespace

VectorLight::VectorLight(const VolumeDesc& desc, const VectorLightOptions& options)
    : options_(options),
      own_(tools::take(irradiance_vector_volume(texture_of(desc).grid, is_floats(desc)),
                       "irradiance vectors")),
      code_(is_floats(desc)),
      field_(VolumeGeometry{texture_of(desc).grid}) {}

void VectorLight::update(const kinds::HeldVolume& volume, double /*time*/) {
  kinds::check_held(volume, own_);
  const kinds::HeldTexture& held = volume.textures.front();
  const std::size_t size = code_.bytes();
  VolumeGeometry geometry = volume.geometry;
  geometry.grid = field_.geometry.grid;
  const std::vector<std::uint32_t> blocks = blocks_by_cell(geometry);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    geometry.origin[axis] += static_cast<float>(geometry.scroll[axis]) * geometry.spacing[axis];
  }
  geometry.scroll = {};
  field_.geometry = geometry;
  for (std::size_t i = 0; i < field_.vertices.size(); ++i) {
    const auto block = held.texels.subspan(blocks[i] * kHemispheres * size, kHemispheres * size);
    const bool lit = std::ranges::any_of(block, [](std::byte b) { return b != std::byte{0}; });
    field_.known[i] = held.has(blocks[i]) && lit ? 1 : 0;
    field_.vertices[i] = {};
    for (std::size_t h = 0; h < kHemispheres && field_.known[i] != 0; ++h) {
      field_.vertices[i][h] = code_.load(&block[h * size]).vectors();
    }
  }
  if (options_.fill != Fill::none) push_pull(field_, options_.fill == Fill::smooth);
}

Vec3 VectorLight::irradiance(const ddgi::SeenSurface& seen) const {
  return field_.irradiance(seen.surface.position, seen.surface.normal, options_.interpolation);
}

}  // namespace gicodec::vectors
