// Volumes of engines other than RTXGI; docs/engines.md has the sources.
#include <gicodec/engines.h>
#include <gicodec/probes.h>
#include <gicodec/textures.h>

#include "base/guard.h"

#include <algorithm>
#include <array>
#include <string>

namespace gicodec {
namespace {

constexpr BlockShape kBrick{4, 4, 4};
/// Blocks of maps, and of 3D textures, for which native codes long rows best.
constexpr BlockShape kTile{8, 8, 1}, kRows{16, 4, 1};

NamedTexture named(std::string name, const TextureDesc& desc, Preview preview = Preview::none) {
  return {std::move(name), desc, Threshold::components, preview};
}

/// Bricks along each axis, at most `most`, of a 3D texture that is filled along x, then y, then z.
Grid filled(std::uint32_t bricks, std::uint32_t most) {
  const auto divided = [](std::uint32_t a, std::uint32_t b) { return a / b + (a % b != 0); };
  const std::uint32_t x = std::clamp(bricks, 1U, most);
  const std::uint32_t rows = divided(bricks, x);
  const std::uint32_t y = std::clamp(rows, 1U, most);
  return {x, y, std::max(divided(rows, y), 1U)};
}

}  // namespace

Result<VolumeDesc> paper_volume(Grid probes) {
  return guarded([&] {
    return probe_volume(
        std::array{named("color", ddgi_irradiance(probes)), named("vis", ddgi_visibility(probes))});
  });
}

Result<VolumeDesc> g3d_volume(Grid probes) {
  return guarded([&] {
    return probe_volume(
        std::array{named("irradiance", ddgi_irradiance(probes, Format::A2B10G10R10_UNORM_PACK32)),
                   named("visibility", ddgi_visibility(probes)),
                   named("probeOffsets", probe_texture(Format::R8G8B8A8_SNORM, probes, 1, 0))});
  });
}

Result<VolumeDesc> o3de_volume(Grid probes) {
  RtxgiOptions options;
  options.axes = RtxgiAxes::left_z_up;
  options.arrays = false;
  options.irradiance = Format::R16G16B16A16_SFLOAT;
  options.distance = Format::R32G32_SFLOAT;
  return rtxgi_volume(probes, options);
}

Result<VolumeDesc> flax_volume(Grid probes, std::uint32_t cascades) {
  return guarded([&]() -> Result<VolumeDesc> {
    if (cascades == 0 || cascades > kMaxGridSide || probes.z > kMaxGridSide / cascades) {
      return Status::invalid_description;
    }
    const Grid all{probes.x, probes.y, probes.z * cascades};
    return probe_volume(std::array{
        named("ProbesIrradiance", probe_texture(Format::B10G11R11_UFLOAT_PACK32, all, 6)),
        named("ProbesDistance", probe_texture(Format::R16G16_SFLOAT, all, 14)),
        named("ProbesData", probe_texture(Format::R8G8B8A8_SNORM, all, 1, 0))});
  });
}

Result<VolumeDesc> unity_apv_volume(std::uint32_t bricks, const UnityApvOptions& options) {
  return guarded([&] {
    constexpr std::uint32_t kMaxSide = 512;  // 3D textures have at most 2048 texels a side.
    const Grid slots = filled(bricks, kMaxSide);
    const auto texture = [&](std::string name, Format format, Preview preview = Preview::none) {
      return named(std::move(name), brick_texture(format, bricks, kBrick, slots), preview);
    };
    TextureGroup light, shared;
    light.bundled = shared.bundled = true;
    light.textures = {texture("L0_L1Rx", Format::R16G16B16A16_SFLOAT, Preview::color),
                      texture("L1G_L1Ry", Format::R8G8B8A8_UNORM),
                      texture("L1B_L1Rz", Format::R8G8B8A8_UNORM)};
    for (unsigned i = 0; i < 4 && options.l2; ++i) {
      light.textures.push_back(
          texture(std::string("L2_").append(std::to_string(i)), Format::R8G8B8A8_UNORM));
    }
    shared.textures = {texture("Validity", Format::R8_UNORM)};
    if (options.sky_occlusion) {
      shared.textures.push_back(texture("SkyOcclusionL0L1", Format::R16G16B16A16_SFLOAT));
    }
    return texture_volume(std::array{light, shared});
  });
}

Result<VolumeDesc> unreal_lightmap_volume(Grid indirection, std::uint32_t bricks) {
  return guarded([&] {
    constexpr std::uint32_t kMaxSide = 256;  // Cells store a brick's position in three bytes.
    const Grid slots = filled(bricks, kMaxSide);
    const auto texture = [&](std::string name, Format format, Preview preview = Preview::none) {
      return named(std::move(name), brick_texture(format, bricks, {5, 5, 5}, slots), preview);
    };
    TextureGroup light, cells;
    light.bundled = true;
    light.textures = {texture("AmbientVector", Format::B10G11R11_UFLOAT_PACK32, Preview::color)};
    for (unsigned i = 0; i < 6; ++i) {
      light.textures.push_back(
          texture(std::string("SHCoefficients").append(std::to_string(i)), Format::B8G8R8A8_UNORM));
    }
    light.textures.push_back(texture("SkyBentNormal", Format::B8G8R8A8_UNORM));
    light.textures.push_back(texture("DirectionalLightShadowing", Format::R8_UNORM));
    cells.textures = {named("Indirection", map_texture(Format::R8G8B8A8_UINT, indirection, kRows))};
    cells.textures.front().threshold = Threshold::exact;
    return texture_volume(std::array{light, cells});
  });
}

Result<VolumeDesc> bevy_volume(Grid voxels) {
  return guarded([&]() -> Result<VolumeDesc> {
    if (voxels.y > kMaxGridSide || voxels.z > kMaxGridSide) return Status::invalid_description;
    TextureGroup group;
    group.textures = {named(
        "voxels",
        map_texture(Format::E5B9G9R9_UFLOAT_PACK32, {voxels.x, 2 * voxels.y, 3 * voxels.z}, kRows),
        Preview::color)};
    return texture_volume(std::span(&group, 1));
  });
}

Result<VolumeDesc> three_volume(Grid probes, Format format) {
  return guarded([&]() -> Result<VolumeDesc> {
    constexpr std::uint32_t kParts = 7, kPadding = 2;
    if (probes.z == 0 || probes.z > kMaxGridSide) return Status::invalid_description;
    const Grid texels{probes.x, probes.y, kParts * (probes.z + kPadding)};
    TextureGroup group;
    group.textures = {named("grid", map_texture(format, texels, kRows))};
    return texture_volume(std::span(&group, 1));
  });
}

Result<VolumeDesc> godot_lightmap_volume(Grid texels, const GodotLightmapOptions& options) {
  return guarded([&]() -> Result<VolumeDesc> {
    if (texels.z > kMaxGridSide) return Status::invalid_description;
    const bool compressed =
        options.format == Format::BC6H_UFLOAT_BLOCK || options.format == Format::BC6H_SFLOAT_BLOCK;
    const auto records = [&](std::uint32_t side) {
      return compressed ? side / 4 + (side % 4 != 0 ? 1 : 0) : side;
    };
    const Grid slices{records(texels.x), records(texels.y),
                      texels.z * (options.directional ? 4 : 1)};
    TextureGroup light, shadows;
    light.textures = {named("lightmap", map_texture(options.format, slices, kTile),
                            compressed ? Preview::none : Preview::color)};
    shadows.textures = {named("shadowmask", map_texture(Format::R8_UNORM, texels, kTile))};
    const std::array groups{light, shadows};
    return texture_volume(std::span(groups).first(options.shadowmask ? 2 : 1));
  });
}

}  // namespace gicodec
