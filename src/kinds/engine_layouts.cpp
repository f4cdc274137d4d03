// The table of engines' layouts.
#include <gicodec/engines.h>

#include <algorithm>
#include <array>

namespace gicodec {
namespace {

Result<VolumeDesc> rtxgi(Grid probes) { return rtxgi_volume(probes); }

Result<VolumeDesc> rtxgi_float16(Grid probes) {
  RtxgiOptions options;
  options.irradiance = Format::R16G16B16A16_SFLOAT;
  return rtxgi_volume(probes, options);
}

Result<VolumeDesc> rtxgi_float32(Grid probes) {
  RtxgiOptions options;
  options.irradiance = options.data = Format::R32G32B32A32_SFLOAT;
  options.distance = Format::R32G32_SFLOAT;
  return rtxgi_volume(probes, options);
}

Result<VolumeDesc> rtxgi_z_up(Grid probes) {
  RtxgiOptions options;
  options.axes = RtxgiAxes::left_z_up;
  return rtxgi_volume(probes, options);
}

Result<VolumeDesc> flax(Grid probes) { return flax_volume(probes); }

/// x·y·z bricks or cells; 0 if too many.
std::uint32_t count(Grid grid) {
  const std::uint64_t plane = std::uint64_t{grid.x} * grid.y;
  return plane > kMaxBlocks || plane * grid.z > kMaxBlocks
             ? 0
             : static_cast<std::uint32_t>(plane * grid.z);
}

Result<VolumeDesc> unity_apv(Grid bricks) { return unity_apv_volume(count(bricks)); }

Result<VolumeDesc> unity_apv_l1(Grid bricks) {
  return unity_apv_volume(count(bricks), {.l2 = false, .sky_occlusion = false});
}

Result<VolumeDesc> unreal_vlm(Grid cells) { return unreal_lightmap_volume(cells, count(cells)); }

Result<VolumeDesc> three(Grid probes) { return three_volume(probes); }

Result<VolumeDesc> three_float32(Grid probes) {
  return three_volume(probes, Format::R32G32B32A32_SFLOAT);
}

Result<VolumeDesc> godot(Grid texels) { return godot_lightmap_volume(texels); }

constexpr std::string_view kYUp = "right up back", kUnity = "right up forward",
                           kUnreal = "forward right up";

constexpr std::array<EngineLayout, 15> kLayouts{{
    {"paper", "Stengel et al.: A2R10G10B10 8+2, RG16F 16+2, atlases", GridUnit::probe, paper_volume,
     kYUp, 1},
    {"g3d", "G3D: A2B10G10R10 8+2, RG16F 16+2, offsets, atlases", GridUnit::probe, g3d_volume, kYUp,
     1},
    {"rtxgi", "RTXGI 1.3: A2B10G10R10 6+2, RG16F 14+2, probe data, arrays", GridUnit::probe, rtxgi,
     "", 0},
    {"rtxgi-float16", "RTXGI 1.3 with irradiance in RGBA16F", GridUnit::probe, rtxgi_float16, "",
     0},
    {"rtxgi-float32", "RTXGI 1.3 with everything in floats of 32 bits", GridUnit::probe,
     rtxgi_float32, "", 0},
    {"rtxgi-z-up", "RTXGI 1.3, left-handed and z-up as in Unreal", GridUnit::probe, rtxgi_z_up,
     kUnreal, 0.01},
    {"o3de", "O3DE: RGBA16F 6+2, RG32F 14+2, atlases", GridUnit::probe, o3de_volume, "", 0},
    {"flax", "Flax: B10G11R11 6+2, RG16F 14+2, probe data, atlases", GridUnit::probe, flax, kUnity,
     0.01},
    {"unity-apv", "Unity APV: bricks of 4^3, L2, validity, sky occlusion", GridUnit::brick,
     unity_apv, kUnity, 1},
    {"unity-apv-l1", "Unity APV: bricks of 4^3, L1, validity", GridUnit::brick, unity_apv_l1,
     kUnity, 1},
    {"unreal-vlm", "Unreal volumetric lightmaps: bricks of 5^3, indirection", GridUnit::cell,
     unreal_vlm, kUnreal, 0.01},
    {"bevy", "Bevy irradiance volumes: ambient cubes in E5B9G9R9", GridUnit::voxel, bevy_volume,
     kYUp, 1},
    {"three", "three.js LightProbeGrid: harmonics in RGBA16F", GridUnit::probe, three, kYUp, 1},
    {"three-float32", "three.js LightProbeGridWebGL: harmonics in RGBA32F", GridUnit::probe,
     three_float32, kYUp, 1},
    {"godot", "Godot LightmapGI: RGBA16F, four slices a layer", GridUnit::texel, godot, kYUp, 1},
}};

}  // namespace

std::span<const EngineLayout> engine_layouts() noexcept { return kLayouts; }

const EngineLayout* find_engine_layout(std::string_view name) noexcept {
  const auto found = std::find_if(kLayouts.begin(), kLayouts.end(),
                                  [name](const EngineLayout& row) { return row.name == name; });
  return found == kLayouts.end() ? nullptr : &*found;
}

}  // namespace gicodec
