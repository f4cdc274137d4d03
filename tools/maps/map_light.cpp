#include "maps.h"

#include "dump/error.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace gicodec::maps {
namespace {

IrradianceMapDesc desc_of(const VolumeDesc& volume) {
  const auto desc = irradiance_map_desc(volume);
  if (!desc) tools::fail(tools::Exit::bad_input, "the volume is no irradiance map");
  if (std::max(desc->width, desc->height) > kMaxTracedSide)
    tools::fail(tools::Exit::bad_input,
                "a map of {}x{} texels cannot be drawn; up to {} a side can", desc->width,
                desc->height, kMaxTracedSide);
  return *desc;
}

/// Of a size that another end chose.
Parameterisation map_of(const ddgi::Scene& scene, const IrradianceMapDesc& desc) {
  try {
    return {scene, desc.width, desc.height};
  } catch (const tools::Error& error) {
    throw tools::Error(tools::Exit::bad_input, error.what());
  }
}

}  // namespace

MapLight::MapLight(const ddgi::RayScene& scene, const VolumeDesc& desc)
    : desc_(desc_of(desc)),
      own_(tools::take(irradiance_map_volume(desc_), "irradiance map")),
      map_(map_of(scene.scene(), desc_)),
      code_(desc_.format),
      received_(std::size_t{desc_.width} * desc_.height),
      shown_(received_.size()),
      exists_(received_.size()) {}

void MapLight::check_hash(const kinds::HeldTexture& hash) const {
  const auto is_zero = [](std::byte b) { return b == std::byte{0}; };
  if (!hash.has(0) || std::ranges::all_of(hash.texels, is_zero)) return;  // not received yet
  const std::vector<std::byte> own = hash_of(map_);
  if (std::memcmp(own.data(), hash.texels.data(), own.size()) != 0) {
    tools::fail(tools::Exit::bad_input,
                "the map's parameterisation is another one than that of the scene here; give both "
                "ends the same scene and the same version");
  }
}

void MapLight::take_map(const kinds::HeldTexture& texels) {
  for (const MapTexel& texel : map_.texels()) {
    if (exists_[texel.place] == 0) continue;
    received_[texel.place] = code_.load(&texels.texels[code_.bytes() * texel.place]);
  }
}

void MapLight::take_bases(const kinds::HeldVolume& volume) {
  const std::span<const std::byte> coefficients = volume.textures[0].texels;
  std::vector<Vec3> bases(coefficients.size() / code_.bytes());
  for (std::size_t i = 0; i < bases.size(); ++i) {
    bases[i] = code_.load(&coefficients[code_.bytes() * i]);
  }
  std::vector<Blend> blends(map_.texels().size());
  for (std::size_t i = 0; i < blends.size(); ++i) {
    std::memcpy(&blends[i], &volume.textures[2].texels[sizeof(Blend) * map_.texels()[i].place],
                sizeof(Blend));
  }
  reconstruct(map_.texels(), blends, bases, received_);
}

void MapLight::update(const kinds::HeldVolume& volume, double time) {
  kinds::check_held(volume, own_);
  check_hash(volume.textures.back());
  const bool by_bases = desc_.way == MapWay::bases;
  exists_ = existence_of(map_, volume.textures[by_bases ? 1 : 0].texels);
  by_bases ? take_bases(volume) : take_map(volume.textures[1]);
  // An exponential average, against popping.
  const bool first = !time_ || !(filter_ > 0) || !(time > *time_);
  const float share = first ? 1 : static_cast<float>(1 - std::exp(-(time - *time_) / filter_));
  time_ = time;
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    shown_[i] = share < 1 ? lerp(shown_[i], received_[i], share) : received_[i];
  }
}

Vec3 MapLight::irradiance(const ddgi::SeenSurface& seen) const {
  return blend(map_.taps(seen.surface), shown_, exists_);
}

}  // namespace gicodec::maps
