// How engines keep their volumes: the textures, by the engines' names for them, in the engines'
// formats and layouts (docs/engines.md: a table, and where it is from).
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

// Each function gives invalid_description where the numbers do not make a volume, and
// unsupported_format for formats that are not known. All may be called from several threads.

/// Stengel et al. §3.2: color A2R10G10B10, 8×8 core, vis RG16F, 16×16 core; one atlas each.
[[nodiscard]] Result<VolumeDesc> paper_volume(Grid probes);
/// G3D::DDGIVolume: the same with R in the low bits, and the probes' offsets, whose signed integers
/// of 8 bits are described as SNORM.
[[nodiscard]] Result<VolumeDesc> g3d_volume(Grid probes);

/// The axes of an RTXGI volume (RTXGI_COORDINATE_SYSTEM), and how probe (x, y, z) is numbered.
enum class RtxgiAxes : std::uint8_t {
  y_up = 0,        ///< left- or right-handed: x + nx·(z + nz·y)
  left_z_up = 1,   ///< Unreal, O3DE: y + ny·(x + nx·z)
  right_z_up = 2,  ///< x + nx·(y + ny·z), as blocks are
};

struct RtxgiOptions {
  RtxgiAxes axes = RtxgiAxes::y_up;
  /// Texture arrays with a slice per horizontal plane (since 1.3); else one 2D atlas, the planes
  /// side by side, and no ProbeData.
  bool arrays = true;
  Format irradiance = Format::A2B10G10R10_UNORM_PACK32;
  Format distance = Format::R16G16_SFLOAT;
  Format data = Format::R16G16B16A16_SFLOAT;
  std::uint8_t irradiance_core = 6, distance_core = 14;  ///< texels without border
};

/// NVIDIA RTXGI's DDGIVolume: ProbeIrradiance, ProbeDistance, ProbeData. Its probes are blocks.
[[nodiscard]] Result<VolumeDesc> rtxgi_volume(Grid probes, const RtxgiOptions& options = {});
/// ProbeData beside atlases, a volume of its own: as many texels wide and high as these have
/// probes, but row by row in the order of the probes' indices. Blocks are 8×8 texels.
[[nodiscard]] Result<VolumeDesc> rtxgi_atlas_data_volume(
    Grid probes, RtxgiAxes axes, Format format = Format::R16G16B16A16_SFLOAT);

/// The block of the probe that RTXGI numbers so, and back. Preconditions: the grid is valid, and
/// has the probe or block.
[[nodiscard]] std::uint32_t block_of_rtxgi_probe(Grid probes, RtxgiAxes axes,
                                                 std::uint32_t probe) noexcept;
[[nodiscard]] std::uint32_t rtxgi_probe_of_block(Grid probes, RtxgiAxes axes,
                                                 std::uint32_t block) noexcept;
/// The blocks of a list of probes, e.g. those that changed: ascending, each once, as Selection
/// wants them. block_out_of_range; invalid_argument for a grid that is none.
[[nodiscard]] Result<std::vector<std::uint32_t>> blocks_of_rtxgi_probes(
    Grid probes, RtxgiAxes axes, std::span<const std::uint32_t> list);
/// One byte per probe, e.g. its activity, as one byte per block for set_active(). mask_mismatch
/// unless there are as many as probes; invalid_argument for a grid that is none.
[[nodiscard]] Result<BlockMask> block_mask_of_rtxgi_probes(Grid probes, RtxgiAxes axes,
                                                           std::span<const std::uint8_t> mask);

/// O3DE's DiffuseProbeGrid: RTXGI's atlases, left-handed and z-up, in RGBA16F and RG32F. ProbeData:
/// rtxgi_atlas_data_volume().
[[nodiscard]] Result<VolumeDesc> o3de_volume(Grid probes);
/// Flax: the cascades below each other, so that blocks of cascade c have z from c·nz on. Within
/// one, indices are RTXGI's of y_up, and blocks go on at c·nx·ny·nz.
[[nodiscard]] Result<VolumeDesc> flax_volume(Grid probes, std::uint32_t cascades = 1);

struct UnityApvOptions {
  bool l2 = true;             ///< four more textures of spherical harmonics
  bool sky_occlusion = true;  ///< L0 and L1 of it
};
/// Unity's adaptive probe volumes: a pool of bricks of 4³ probes, of which chunks have 128. A brick
/// travels in all textures of light at once, and in validity and sky occlusion, which all lighting
/// scenarios share, at once.
[[nodiscard]] Result<VolumeDesc> unity_apv_volume(std::uint32_t bricks,
                                                  const UnityApvOptions& options = {});

/// Unreal's volumetric lightmaps: a pool of bricks of 4³ samples, each stored with a face of its
/// neighbours as 5³, and an indirection texture whose cells say which brick is theirs. The faces
/// are data: next to bricks of another size they are interpolated.
[[nodiscard]] Result<VolumeDesc> unreal_lightmap_volume(Grid indirection, std::uint32_t bricks);

/// Bevy's irradiance volumes: ambient cubes of Rx × Ry × Rz voxels in one 3D texture of
/// Rx × 2·Ry × 3·Rz texels.
[[nodiscard]] Result<VolumeDesc> bevy_volume(Grid voxels);

struct GodotLightmapOptions {
  bool directional = true;  ///< four slices per layer, L0 and L1
  bool shadowmask = false;
  Format format = Format::R16G16B16A16_SFLOAT;  ///< or BC6H, as it is imported by default
};
/// Godot's LightmapGI: an array of that many texels and layers.
[[nodiscard]] Result<VolumeDesc> godot_lightmap_volume(Grid texels,
                                                       const GodotLightmapOptions& options = {});

/// What the grid of an EngineLayout counts.
enum class GridUnit : std::uint8_t {
  probe = 0,  ///< probes
  brick = 1,  ///< bricks of a pool, x·y·z of them
  cell = 2,   ///< cells of an indirection texture, each with a brick of its own
  voxel = 3,  ///< voxels of a 3D texture
  texel = 4,  ///< texels and layers of a lightmap
};

/// How an engine keeps a volume, for those who choose by name.
struct EngineLayout {
  std::string_view name;     ///< for --layout, e.g. "rtxgi", "unity-apv"
  std::string_view summary;  ///< one line, for help
  GridUnit unit;
  Result<VolumeDesc> (*make)(Grid grid);
};
/// Every engine and its variants, by engine.
[[nodiscard]] std::span<const EngineLayout> engine_layouts() noexcept;
/// nullptr if unknown.
[[nodiscard]] const EngineLayout* find_engine_layout(std::string_view name) noexcept;

}  // namespace gicodec
