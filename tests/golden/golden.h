// What the golden files hold: contents by fixed formulas, so that none need to be stored. Formats
// are named one by one, since more may come.
#pragma once

#include "container_support.h"

#include <gicodec/irradiance_vectors.h>
#include "support.h"

#include <array>

namespace gicodec::golden {

inline constexpr std::uint32_t kFrames = 5;
inline constexpr std::uint32_t kIndexBlocks = 64;

inline constexpr std::array kSequenceFormats = {Format::R8G8B8A8_UNORM,
                                                Format::R8G8B8A8_SNORM,
                                                Format::B8G8R8A8_UNORM,
                                                Format::R16_SFLOAT,
                                                Format::A2R10G10B10_UNORM_PACK32,
                                                Format::A2B10G10R10_UNORM_PACK32,
                                                Format::R16_UNORM,
                                                Format::R16G16_SFLOAT,
                                                Format::R16G16B16A16_UNORM,
                                                Format::R32_UINT,
                                                Format::R32_SFLOAT,
                                                Format::R32G32_SFLOAT,
                                                Format::R32G32B32_SFLOAT,
                                                Format::R32G32B32A32_SFLOAT,
                                                Format::B10G11R11_UFLOAT_PACK32,
                                                Format::E5B9G9R9_UFLOAT_PACK32,
                                                Format::R8_UNORM,
                                                Format::R8_UINT,
                                                Format::R8G8_UNORM,
                                                Format::R8G8B8_SNORM,
                                                Format::R16G16B16A16_SFLOAT,
                                                Format::BC6H_UFLOAT_BLOCK,
                                                Format::BC6H_SFLOAT_BLOCK,
                                                Format::BC7_UNORM_BLOCK,
                                                Format::BC7_SRGB_BLOCK};

/// The textures of sequence_BACKEND.gic, for every backend: a volume of probes with one of each
/// format.
inline std::vector<test::ProbeTexture> sequence_textures() {
  std::vector<test::ProbeTexture> textures;
  for (std::size_t i = 0; i < kSequenceFormats.size(); ++i) {
    const Format format = kSequenceFormats[i];
    const TextureDesc desc =
        probe_texture(format, {3, 1, 2}, static_cast<std::uint8_t>(1 + i % 4),
                      static_cast<std::uint8_t>(i % 3 != 2), static_cast<Tiling>(i % 6));
    textures.push_back(
        {std::string(find_format(format)->name), desc, {{"place", std::to_string(i)}}});
  }
  return textures;
}

/// A byte of record (x, y, z) of a block in a frame. Smooth with some noise; most blocks rest.
inline std::byte record_byte(std::uint32_t frame, std::uint32_t block, std::uint32_t x,
                             std::uint32_t y, std::uint32_t z, std::uint32_t byte) {
  const std::uint32_t updates = (frame + block) / 3;
  const std::uint32_t noise =
      (((x * 31 + y) * 37 + z * 59 + block * 11 + updates) * 2654435761U) >> 29;
  return static_cast<std::byte>(byte * 64 + x * 3 + y * 5 + z * 9 + block * 7 + updates * 2 +
                                noise);
}

/// The whole texture in a frame. Block 4 has one stale record in its guard band, from frame 2 on
/// another one.
inline void paint(test::Texture& texture, std::uint32_t frame) {
  const TextureDesc& desc = texture.desc();
  const std::uint32_t band = desc.guard_band;
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    const BlockShape inside = block_inside(desc, block);
    for (std::uint32_t z = 0; z < inside.z; ++z) {
      for (std::uint32_t y = 0; y < inside.y; ++y) {
        for (std::uint32_t x = 0; x < inside.x; ++x) {
          const auto record = texture.record(block, x + band, y + band, z);
          for (std::uint32_t byte = 0; byte < record.size(); ++byte) {
            record[byte] = record_byte(frame, block, x, y, z, byte);
          }
        }
      }
    }
    texture.fill_band(block);
    if (band == 1 && block == 4) texture.record(block, frame < 2 ? 0 : 1, 0)[0] ^= std::byte{0x55};
  }
}

/// What blocks_NAME_1.packet, a keyframe, and blocks_NAME_2.packet, an update, are made for.
struct Blocks {
  std::string_view name;
  TextureDesc desc;
};
inline std::vector<Blocks> block_textures() {
  const auto with = [](const Record& record, Space space, Grid grid, BlockShape block, Model model,
                       Presence presence) {
    TextureDesc desc;
    desc.record = record;
    desc.space = space;
    desc.grid = grid;
    desc.block = block;
    desc.presence = presence;
    desc.model = model;
    desc.layout = Tiling::blocks;
    return desc;
  };
  Record own;
  own.bytes = 6;
  own.count = 4;
  own.components[0] = {"r", 0, 11, ComponentType::ufloat};
  own.components[1] = {"b", 22, 10, ComponentType::ufloat};
  own.components[2] = {"g", 11, 11, ComponentType::ufloat};
  own.components[3] = {"flags_2", 32, 16, ComponentType::opaque};
  TextureDesc bricks =
      with(Format::R16_SFLOAT, Space::grid, {3, 2, 2}, {4, 4, 2}, Model::continuous, Presence::all);
  bricks.records = {10, 8, 3};
  const auto vertices = [&](bool floats) {
    return with(colored_direction(floats), Space::grid, {3, 2, 2}, {6, 1, 1}, Model::hemispheres,
                Presence::all);
  };
  const auto voxels = [&](Format format) {
    return with(format, Space::pool, {6, 1, 1}, {12, 2, 2}, Model::octree, Presence::brick);
  };
  return {{"own", with(own, Space::grid, {2, 2, 1}, {3, 2, 2}, Model::stacked, Presence::all)},
          {"bricks", bricks},
          {"set", with(Format::R32_UINT, Space::pool, {7, 1, 1}, {2, 2, 2}, Model::unordered,
                       Presence::all)},
          {"count", with(Format::R8G8B8_SNORM, Space::pool, {9, 1, 1}, {6, 1, 1}, Model::none,
                         Presence::count)},
          {"mask", with(Format::E5B9G9R9_UFLOAT_PACK32, Space::pool, {5, 1, 1}, {5, 3, 1},
                        Model::none, Presence::mask)},
          {"vectors", vertices(false)},
          {"vector_floats", vertices(true)},
          {"voxels", voxels(Format::E5B9G9R9_UFLOAT_PACK32)},
          {"voxel_halves", voxels(Format::R16G16B16A16_SFLOAT)}};
}
/// Which records exist; empty where all do.
inline test::Bytes block_presence(const TextureDesc& desc) {
  test::Bytes presence(presence_bytes(desc) * block_count(desc));
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    if (desc.presence == Presence::count) presence[2 * block] = static_cast<std::byte>(block % 7);
    if (desc.presence == Presence::mask) {
      presence[2 * block] = static_cast<std::byte>(0x35 * (block + 1));
      presence[2 * block + 1] = static_cast<std::byte>(0x2B * block & 0x7F);
    }
    // The last one is the parent of those before it.
    if (desc.presence == Presence::brick) {
      std::byte* const one = &presence[presence_bytes(desc) * block];
      const bool parent = block + 1 == block_count(desc);
      one[0] = static_cast<std::byte>(parent ? 0 : block);
      one[7] = static_cast<std::byte>(parent ? 1 : 0);
      one[8] = static_cast<std::byte>(parent ? 0x1F : 0x35 * (block + 1) & 0xFF);
    }
  }
  return presence;
}
inline bool exists(const TextureDesc& desc, std::span<const std::byte> presence,
                   std::uint32_t block, std::uint32_t record) {
  const auto at = [&](std::size_t byte) {
    return std::to_integer<std::uint32_t>(presence[presence_bytes(desc) * block + byte]);
  };
  if (desc.presence == Presence::count) return record < at(0) + 256 * at(1);
  if (desc.presence == Presence::brick) return (at(8) >> record / kVoxelDirections & 1) != 0;
  return desc.presence == Presence::all || (at(record / 8) >> record % 8 & 1) != 0;
}

/// The texture of the packets index_MODE.packet: single records, value 257 · (block + 1) if listed.
inline TextureDesc index_desc() { return probe_texture(Format::R16_SFLOAT, {8, 4, 2}, 1, 0); }
inline std::vector<std::uint32_t> index_blocks(std::string_view mode) {
  std::vector<std::uint32_t> blocks;
  for (std::uint32_t block = 0; block < kIndexBlocks; ++block) {
    const bool listed = mode == "all"      ? true
                        : mode == "bitmap" ? block * block * 2654435761U >> 31 != 0
                        : mode == "gaps"   ? block * block * 2654435761U >> 28 == 3
                        : mode == "runs"   ? block >= 3 && block < 60 && block != 31
                                           : false;
    if (listed) blocks.push_back(block);
  }
  return blocks;
}
inline constexpr std::string_view kIndexModes[] = {"all", "bitmap", "gaps", "runs", "empty"};

/// What volumes.gic describes: probes cut into regions, irradiance vectors of both forms, a volume
/// of a kind that is not known.
inline constexpr std::uint8_t kFutureKind = 120;
inline ContainerDescription volumes_description() {
  ContainerDescription description;
  const NamedTexture probes[] = {
      {"color", probe_texture(Format::A2B10G10R10_UNORM_PACK32, {3, 2, 2}, 2), {}, {}},
      {"visibility", probe_texture(Format::R16G16_SFLOAT, {3, 2, 2}, 3), {}, {}}};
  if (add_volume(description, "near", *probe_volume(probes)) != Status::ok ||
      add_volume(description, "hall", *irradiance_vector_volume({2, 2, 1})) != Status::ok ||
      add_volume(description, "", *irradiance_vector_volume({1, 2, 2}, true)) != Status::ok) {
    return {};
  }
  VolumeEntry future;
  future.name = "future";
  future.kind = kFutureKind;
  future.description = test::Bytes(5, std::byte{0xA5});
  future.first_texture = static_cast<std::uint32_t>(description.textures.size());
  future.textures = 1;
  TextureEntry texture;
  texture.name = "slots";
  texture.volume = static_cast<std::uint32_t>(description.volumes.size());
  description.volumes.push_back(future);
  description.textures.push_back(texture);

  description.epoch = 0x0123456789ABCDEF;
  description.scene = {"golden scene", 0xFEDCBA9876543210};
  description.volumes[0].region = {2, 1, 2};
  description.volumes[0].geometry = {{3, 2, 2}, {-1, 0.5F, 8}, {0.25F, 2, 1}, {0, -3, kMaxScroll}};
  description.volumes[0].metadata = {{"role", "cascade"}, {"", ""}};
  description.textures[0].largest_error = 2.5F;
  description.textures[1].metadata = {{"unit", "m"}};
  description.textures[2].largest_error = std::numeric_limits<float>::infinity();
  description.metadata = {{"golden", "volumes"}};
  return description;
}
/// What its packets are made for: of the unknown kind something all the same.
inline TextureDesc volumes_texture(const ContainerDescription& description, std::uint8_t texture_id,
                                   std::uint32_t region) {
  const TextureEntry& texture = description.textures[texture_id];
  if (!is_known(texture)) return index_desc();
  if (region == StreamId::kWholeVolume) return texture.desc;
  return region_texture(texture.desc, description.volumes[texture.volume].region, region);
}
/// What paint() is asked for: with regions counted from 1 on.
inline std::uint32_t volumes_step(std::uint64_t frame, std::uint32_t region) {
  return static_cast<std::uint32_t>(frame) + region + 1;
}
inline std::uint32_t volumes_regions(const ContainerDescription& description,
                                     std::uint8_t texture_id) {
  const TextureEntry& texture = description.textures[texture_id];
  const Grid& size = description.volumes[texture.volume].region;
  return size.x == 0 ? 0 : regions_of(texture.desc, size).regions();
}
inline constexpr std::uint32_t kVolumesFrames = 4;

}  // namespace gicodec::golden
