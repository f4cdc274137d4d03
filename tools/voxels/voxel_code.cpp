#include "voxel_code.h"

#include "ddgi/texels.h"

#include <cmath>
#include <cstdint>
#include <cstring>

namespace gicodec::voxels {
namespace {

float sound_half(std::uint16_t bits) {
  const float value = ddgi::from_half(bits);
  return std::isfinite(value) && value > 0 ? value : 0.0F;
}

}  // namespace

void VoxelCode::store(std::byte* record, const Voxel& light) const {
  for (std::size_t d = 0; d < kVoxelDirections; ++d, record += part()) {
    const Vec3 c = light.color[d];
    if (halves_) {
      const std::array<std::uint16_t, 4> texel{ddgi::to_half(c.x), ddgi::to_half(c.y),
                                               ddgi::to_half(c.z), ddgi::to_half(light.cover[d])};
      std::memcpy(record, texel.data(), sizeof texel);
    } else {
      const std::uint32_t texel = ddgi::to_shared_exponent(c);
      std::memcpy(record, &texel, sizeof texel);
    }
  }
}

Voxel VoxelCode::load(const std::byte* record) const {
  Voxel light;
  for (std::size_t d = 0; d < kVoxelDirections; ++d) {
    light.color[d] = color(record, d);
    if (!halves_) continue;
    std::uint16_t cover = 0;
    std::memcpy(&cover, record + d * part() + 6, sizeof cover);
    light.cover[d] = sound_half(cover);
  }
  return light;
}

Vec3 VoxelCode::color(const std::byte* record, std::size_t direction) const {
  record += direction * part();
  if (halves_) {
    std::array<std::uint16_t, 3> texel{};
    std::memcpy(texel.data(), record, sizeof texel);
    return {sound_half(texel[0]), sound_half(texel[1]), sound_half(texel[2])};
  }
  std::uint32_t texel = 0;
  std::memcpy(&texel, record, sizeof texel);
  return ddgi::from_shared_exponent(texel);
}

}  // namespace gicodec::voxels
