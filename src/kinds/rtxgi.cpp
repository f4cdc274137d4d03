// NVIDIA RTXGI's volumes, and the indices of their probes.
#include <gicodec/engines.h>
#include <gicodec/probes.h>
#include <gicodec/textures.h>

#include "base/guard.h"

#include <algorithm>
#include <array>

namespace gicodec {
namespace {

struct Axes {
  Tiling atlas, array;
  std::array<std::uint8_t, 3> order;  ///< axes in the order of the index, fastest first
};

constexpr std::array<Axes, 3> kAxes{{
    {Tiling::atlas_xy_z, Tiling::slices_xz_y, {0, 2, 1}},
    {Tiling::atlas_yz_x, Tiling::slices_yx_z, {1, 0, 2}},
    {Tiling::atlas_xz_y, Tiling::slices_xy_z, {0, 1, 2}},
}};

using Sides = std::array<std::uint32_t, 3>;

constexpr Sides sides_of(Grid grid) { return {grid.x, grid.y, grid.z}; }

bool known(RtxgiAxes axes) { return static_cast<std::size_t>(axes) < kAxes.size(); }

const Axes& row(RtxgiAxes axes) { return kAxes[static_cast<std::size_t>(axes)]; }

std::uint64_t probes_of(Grid grid) { return std::uint64_t{grid.x} * grid.y * grid.z; }

bool valid(Grid grid, RtxgiAxes axes) {
  const auto side = [](std::uint32_t n) { return n >= 1 && n <= kMaxGridSide; };
  return known(axes) && side(grid.x) && side(grid.y) && side(grid.z) &&
         std::uint64_t{grid.x} * grid.y <= kMaxBlocks && probes_of(grid) <= kMaxBlocks;
}

Preview preview_of(const Record& record) {
  return record.count >= 3 ? Preview::color : Preview::distance;
}

}  // namespace

Result<VolumeDesc> rtxgi_volume(Grid probes, const RtxgiOptions& options) {
  return guarded([&]() -> Result<VolumeDesc> {
    if (!valid(probes, options.axes)) return Status::invalid_description;
    const Axes& axes = row(options.axes);
    const Tiling tiling = options.arrays ? axes.array : axes.atlas;
    const auto texture = [&](const char* name, Format format, std::uint8_t core) {
      const TextureDesc desc = probe_texture(format, probes, core, core > 1 ? 1 : 0, tiling);
      return NamedTexture{name, desc, Threshold::components, preview_of(desc.record)};
    };
    std::vector<NamedTexture> textures{
        texture("ProbeIrradiance", options.irradiance, options.irradiance_core),
        texture("ProbeDistance", options.distance, options.distance_core)};
    if (options.arrays) textures.push_back(texture("ProbeData", options.data, 1));
    return probe_volume(textures);
  });
}

Result<VolumeDesc> rtxgi_atlas_data_volume(Grid probes, RtxgiAxes axes, Format format) {
  return guarded([&]() -> Result<VolumeDesc> {
    if (!valid(probes, axes)) return Status::invalid_description;
    const Extent size = extent(probe_texture(format, probes, 1, 0, row(axes).atlas));
    const Grid texels{static_cast<std::uint32_t>(size.width),
                      static_cast<std::uint32_t>(size.height), 1};
    TextureGroup group;
    group.textures = {{"ProbeData", map_texture(format, texels, {8, 8, 1})}};
    return texture_volume(std::span(&group, 1));
  });
}

std::uint32_t block_of_rtxgi_probe(Grid probes, RtxgiAxes axes, std::uint32_t probe) noexcept {
  const Sides n = sides_of(probes);
  Sides at{};
  for (const std::uint8_t axis : row(axes).order) {
    at[axis] = probe % n[axis];
    probe /= n[axis];
  }
  return at[0] + n[0] * (at[1] + n[1] * at[2]);
}

std::uint32_t rtxgi_probe_of_block(Grid probes, RtxgiAxes axes, std::uint32_t block) noexcept {
  const Sides n = sides_of(probes);
  const Sides at{block % n[0], block / n[0] % n[1], block / n[0] / n[1]};
  const auto& order = row(axes).order;
  return at[order[0]] + n[order[0]] * (at[order[1]] + n[order[1]] * at[order[2]]);
}

Result<std::vector<std::uint32_t>> blocks_of_rtxgi_probes(Grid probes, RtxgiAxes axes,
                                                          std::span<const std::uint32_t> list) {
  return guarded([&]() -> Result<std::vector<std::uint32_t>> {
    if (!valid(probes, axes)) return Status::invalid_argument;
    std::vector<std::uint32_t> blocks;
    blocks.reserve(list.size());
    for (const std::uint32_t probe : list) {
      if (probe >= probes_of(probes)) return Status::block_out_of_range;
      blocks.push_back(block_of_rtxgi_probe(probes, axes, probe));
    }
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    return blocks;
  });
}

Result<BlockMask> block_mask_of_rtxgi_probes(Grid probes, RtxgiAxes axes,
                                             std::span<const std::uint8_t> mask) {
  return guarded([&]() -> Result<BlockMask> {
    if (!valid(probes, axes)) return Status::invalid_argument;
    if (mask.size() != probes_of(probes)) return Status::mask_mismatch;
    BlockMask blocks(mask.size());
    for (std::uint32_t probe = 0; probe < mask.size(); ++probe) {
      blocks[block_of_rtxgi_probe(probes, axes, probe)] = mask[probe];
    }
    return blocks;
  });
}

}  // namespace gicodec
