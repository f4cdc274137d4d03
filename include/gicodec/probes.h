// Light probes (DDGI): a grid of square blocks, with textures for colour and visibility (Stengel et
// al. §3.2), and the variants of engines.
#pragma once

#include <gicodec/api.h>
#include <gicodec/kind.h>
#include <gicodec/texture.h>
#include <gicodec/volume.h>

#include <cstdint>
#include <span>

namespace GICODEC_API gicodec {

inline constexpr std::uint8_t kKindProbes = 1;

/// A texture of square blocks of core × core records, with a guard band of 0 or 1 around each.
[[nodiscard]] inline TextureDesc probe_texture(const Record& record, Grid grid, std::uint8_t core,
                                               std::uint8_t guard_band = 1,
                                               Tiling tiling = Tiling::atlas_xy_z) noexcept {
  TextureDesc desc;
  desc.record = record;
  desc.grid = grid;
  desc.block = {core, core, 1};
  desc.guard_band = guard_band;
  desc.layout = tiling;
  return desc;
}

/// The paper's textures, with guard bands: colour with a core of 8×8 texels, visibility of 16×16.
[[nodiscard]] inline TextureDesc ddgi_irradiance(Grid grid,
                                                 Format format = Format::A2R10G10B10_UNORM_PACK32,
                                                 Tiling tiling = Tiling::atlas_xy_z) noexcept {
  return probe_texture(format, grid, 8, 1, tiling);
}
[[nodiscard]] inline TextureDesc ddgi_visibility(Grid grid, Format format = Format::R16G16_SFLOAT,
                                                 Tiling tiling = Tiling::atlas_xy_z) noexcept {
  return probe_texture(format, grid, 16, 1, tiling);
}

/// Adds the probes that shade the given points to `mask`: the cage of eight around each point. A
/// point outside the volume belongs to the nearest cage, as shaders clamp it. Ignores points that
/// are not finite. Precondition: mask.size() is the number of probes.
void add_shading_probes(const VolumeGeometry& geometry, std::span<const Position> points,
                        std::span<std::uint8_t> mask) noexcept;

/// Kind 1: one group of 1..255 textures, made by probe_texture(), over one grid.
extern const Kind kProbes;
/// A volume of this kind. invalid_description if the textures do not make one.
[[nodiscard]] Result<VolumeDesc> probe_volume(std::span<const NamedTexture> textures);

}  // namespace gicodec
