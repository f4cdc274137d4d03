// Volumes of engines: their textures, with the engines' names, formats and layouts (docs/engines.md
// has a table and its sources).
#pragma once

#include <gicodec/api.h>
#include <gicodec/kind.h>
#include <gicodec/record.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>
#include <gicodec/volume.h>

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace GICODEC_API gicodec {

// Each function answers invalid_description if the numbers do not make a volume, and
// unsupported_format for unknown formats. Several threads may call all of them at once.

/// Stengel et al. §3.2: "color" A2R10G10B10 with a core of 8×8, "vis" RG16F of 16×16; atlases.
[[nodiscard]] Result<VolumeDesc> paper_volume(Grid probes);
/// G3D::DDGIVolume: the same with R in the low bits, and the probes' offsets, signed 8-bit integers
/// that are described as SNORM.
[[nodiscard]] Result<VolumeDesc> g3d_volume(Grid probes);

/// Axes of an RTXGI volume (RTXGI_COORDINATE_SYSTEM), with the index of probe (x, y, z).
enum class RtxgiAxes : std::uint8_t {
  y_up = 0,        ///< left- or right-handed: x + nx·(z + nz·y)
  left_z_up = 1,   ///< Unreal, O3DE: y + ny·(x + nx·z)
  right_z_up = 2,  ///< x + nx·(y + ny·z), the block index
};

struct RtxgiOptions {
  RtxgiAxes axes = RtxgiAxes::y_up;
  /// True: texture arrays with a slice per horizontal plane (RTXGI 1.3 on). False: 2D atlases with
  /// the planes side by side, without ProbeData.
  bool arrays = true;
  Format irradiance = Format::A2B10G10R10_UNORM_PACK32;
  Format distance = Format::R16G16_SFLOAT;
  Format data = Format::R16G16B16A16_SFLOAT;
  std::uint8_t irradiance_core = 6, distance_core = 14;  ///< texels along a side, without border
};

/// NVIDIA RTXGI's DDGIVolume: ProbeIrradiance, ProbeDistance, ProbeData. A probe is a block.
[[nodiscard]] Result<VolumeDesc> rtxgi_volume(Grid probes, const RtxgiOptions& options = {});
/// ProbeData beside atlases, as a volume: as many texels wide and high as the atlases have probes,
/// row by row in the order of probe indices, cut into blocks of 8×8 texels.
[[nodiscard]] Result<VolumeDesc> rtxgi_atlas_data_volume(
    Grid probes, RtxgiAxes axes, Format format = Format::R16G16B16A16_SFLOAT);

/// The block index of an RTXGI probe index, and the inverse. Preconditions: the grid is valid and
/// has the probe or block.
[[nodiscard]] std::uint32_t block_of_rtxgi_probe(Grid probes, RtxgiAxes axes,
                                                 std::uint32_t probe) noexcept;
[[nodiscard]] std::uint32_t rtxgi_probe_of_block(Grid probes, RtxgiAxes axes,
                                                 std::uint32_t block) noexcept;
/// The block indices of a list of probes, e.g. the changed ones, ascending and unique, for
/// Selection. block_out_of_range; invalid_argument for an invalid grid.
[[nodiscard]] Result<std::vector<std::uint32_t>> blocks_of_rtxgi_probes(
    Grid probes, RtxgiAxes axes, std::span<const std::uint32_t> list);
/// Reorders one byte per probe, e.g. its activity, into one byte per block, for set_active().
/// mask_mismatch unless `mask` has a byte per probe; invalid_argument for an invalid grid.
[[nodiscard]] Result<BlockMask> block_mask_of_rtxgi_probes(Grid probes, RtxgiAxes axes,
                                                           std::span<const std::uint8_t> mask);

/// O3DE's DiffuseProbeGrid: RTXGI's atlases, left-handed and z-up, in RGBA16F and RG32F. For its
/// ProbeData use rtxgi_atlas_data_volume().
[[nodiscard]] Result<VolumeDesc> o3de_volume(Grid probes);
/// Flax: cascades stacked along z: blocks of cascade c begin at z = c·nz, index c·nx·ny·nz. Within
/// a cascade, probes are numbered as by RtxgiAxes::y_up.
[[nodiscard]] Result<VolumeDesc> flax_volume(Grid probes, std::uint32_t cascades = 1);

struct UnityApvOptions {
  bool l2 = true;             ///< with the four L2 textures of spherical harmonics
  bool sky_occlusion = true;  ///< with L0 and L1 of sky occlusion
};
/// Unity's adaptive probe volumes: a pool of bricks of 4³ probes, 128 bricks per chunk. Two groups
/// of bundled textures: light, and what all lighting scenarios share (validity, sky occlusion).
[[nodiscard]] Result<VolumeDesc> unity_apv_volume(std::uint32_t bricks,
                                                  const UnityApvOptions& options = {});

/// Unreal's volumetric lightmaps: a pool of bricks of 4³ samples, each stored as 5³ with a face of
/// its neighbours, and an indirection texture whose cells refer to bricks. The faces are data,
/// because they are interpolated next to bricks of another size.
[[nodiscard]] Result<VolumeDesc> unreal_lightmap_volume(Grid indirection, std::uint32_t bricks);

/// Bevy's irradiance volumes: the ambient cubes of Rx × Ry × Rz voxels in one 3D texture of Rx ×
/// 2·Ry × 3·Rz texels.
[[nodiscard]] Result<VolumeDesc> bevy_volume(Grid voxels);

/// three.js's LightProbeGrid: nine spherical harmonics of radiance for each colour in one 3D
/// texture of nx × ny × 7·(nz + 2) texels. Number n, of harmonic n / 3 and colour n mod 3, is
/// component n mod 4 of sub-volume n / 4. Each sub-volume has a slice before and behind, a copy of
/// the nearest one. Halves for WebGPURenderer, R32G32B32A32_SFLOAT for WebGLRenderer.
[[nodiscard]] Result<VolumeDesc> three_volume(Grid probes,
                                              Format format = Format::R16G16B16A16_SFLOAT);

struct GodotLightmapOptions {
  bool directional = true;  ///< four slices per layer, L0 and L1
  bool shadowmask = false;
  Format format = Format::R16G16B16A16_SFLOAT;  ///< or BC6H, Godot's import default
};
/// Godot's LightmapGI: an array of `texels`, width × height × layers.
[[nodiscard]] Result<VolumeDesc> godot_lightmap_volume(Grid texels,
                                                       const GodotLightmapOptions& options = {});

/// The unit of an EngineLayout's grid.
enum class GridUnit : std::uint8_t {
  probe = 0,
  brick = 1,  ///< bricks of a pool, x·y·z of them
  cell = 2,   ///< cells of an indirection texture, each with a brick of its own
  voxel = 3,  ///< voxels of a 3D texture
  texel = 4,  ///< texels and layers of a lightmap
};

/// An engine's layout, to choose by name.
struct EngineLayout {
  std::string_view name;     ///< for --layout, e.g. "rtxgi", "unity-apv"
  std::string_view summary;  ///< one line, for help
  GridUnit unit;
  Result<VolumeDesc> (*make)(Grid grid);
  /// Where +x, +y and +z of the engine's world point (FORMAT.md, "Keys"), and the metres of its
  /// unit. Empty and 0 where the engine leaves it open.
  std::string_view axes;
  double metres = 0;
};
/// All layouts, grouped by engine; static storage.
[[nodiscard]] std::span<const EngineLayout> engine_layouts() noexcept;
/// nullptr if unknown.
[[nodiscard]] const EngineLayout* find_engine_layout(std::string_view name) noexcept;

}  // namespace gicodec
