// One row per kind: what the conformance test and its fuzz target go through.
#pragma once

#include <gicodec/ao_points.h>
#include <gicodec/irradiance_maps.h>
#include <gicodec/irradiance_vectors.h>
#include <gicodec/kind.h>
#include <gicodec/photons.h>
#include <gicodec/probes.h>
#include <gicodec/textures.h>
#include <gicodec/voxels.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

namespace gicodec::test {

/// A kind of the tests' own with everything that the model has: bricks of 4³ in a pool, a mask of
/// what exists, ranks; a map that ends within its tiles, continuous, of large records; lights that
/// name bricks.
inline constexpr std::uint8_t kKindScenes = 201;

inline Record bits(std::initializer_list<std::uint8_t> widths, ComponentType kind) {
  Record record;
  std::uint16_t at = 0;
  for (const std::uint8_t width : widths) {
    record.components[record.count] = {std::string("c").append(std::to_string(record.count)), at,
                                       width, kind};
    ++record.count;
    at = static_cast<std::uint16_t>(at + width);
  }
  record.bytes = static_cast<std::uint8_t>(at / 8);
  return record;
}

inline std::size_t bricks_of(std::span<const std::byte> light, std::span<std::uint32_t> out) {
  std::uint32_t brick = 0;
  std::memcpy(&brick, light.data(), sizeof brick);
  if (!out.empty()) out[0] = brick;
  return 1;
}

inline float fullness(std::span<const std::byte> mask) {
  float sum = 0;
  for (const std::byte byte : mask) sum += static_cast<float>(byte != std::byte{0});
  return sum;
}

inline VolumeDesc scene_volume(std::uint32_t slots) {
  TextureDesc light_of_brick = pool_texture(Format::E5B9G9R9_UFLOAT_PACK32, slots, {4, 4, 4});
  light_of_brick.presence = Presence::mask;
  TextureGroup bricks;
  bricks.textures = {
      {"occupancy", pool_texture(bits({32, 32}, ComponentType::opaque), slots, {1, 1, 1}),
       Threshold::exact},
      {"up", light_of_brick},
      {"down", light_of_brick}};
  bricks.bundled = true;
  bricks.presence = 0;
  bricks.rank = fullness;

  TextureDesc map;
  map.record = bits({16, 16, 16, 16, 16, 16, 16, 16, 16, 16, 16, 16}, ComponentType::uint);
  map.grid = {3, 2, 1};
  map.block = {8, 8, 1};
  map.records = {19, 11, 1};
  map.model = Model::continuous;
  map.layout = Tiling::slices_xy_z;
  TextureGroup maps;
  maps.textures = {{"blend", map}};

  TextureGroup lights;
  lights.textures = {
      {"lights", pool_texture(bits({32, 5, 11, 16}, ComponentType::uint), 6, {1, 1, 1})}};
  lights.depends_on = 0;
  lights.dependencies = bricks_of;
  return {kKindScenes, {bricks, maps, lights}};
}

inline Status write_scene(const VolumeDesc& volume, std::vector<std::byte>& out) {
  if (volume.groups.size() != 3 || volume.groups[0].textures.empty())
    return Status::invalid_description;
  const std::uint32_t slots = volume.groups[0].textures[0].desc.grid.x;
  if (!same_but_layout(scene_volume(slots), volume)) return Status::invalid_description;
  for (unsigned byte = 0; byte < 4; ++byte) out.push_back(std::byte(slots >> 8 * byte));
  return Status::ok;
}

inline Result<VolumeDesc> read_scene(std::span<const std::byte> description) {
  std::uint32_t slots = 0;
  if (description.size() != sizeof slots) return Status::corrupt;
  std::memcpy(&slots, description.data(), sizeof slots);
  VolumeDesc volume = scene_volume(slots);
  if (validate(volume) != Status::ok) return Status::corrupt;
  return volume;
}

inline constexpr Kind kScenes{kKindScenes, "scenes", write_scene, read_scene, nullptr};

/// What kind 3 has: probes with a guard band beside plain texels, a 3D texture that ends within its
/// blocks, an array, bricks of a pool.
inline VolumeDesc plain_volume() {
  TextureGroup probes, volume, array, bricks;
  probes.textures = {{"irradiance", probe_texture(Format::R16G16B16A16_SFLOAT, {3, 2, 2}, 6),
                      Threshold::components, Preview::color},
                     {"distance", probe_texture(Format::R32G32_SFLOAT, {3, 2, 2}, 5),
                      Threshold::components, Preview::distance}};
  volume.textures = {{"voxels", map_texture(Format::E5B9G9R9_UFLOAT_PACK32, {7, 10, 9}, {4, 4, 4}),
                      Threshold::exact}};
  array.textures = {{"lightmap", map_texture(Format::BC6H_UFLOAT_BLOCK, {8, 9, 3}, {8, 8, 1})}};
  bricks.bundled = true;
  bricks.textures = {
      {"ambient", brick_texture(Format::B10G11R11_UFLOAT_PACK32, 5, {5, 5, 5}, {2, 2, 2})},
      {"shadowing", brick_texture(Format::R8_UNORM, 5, {5, 5, 5}, {2, 2, 2})}};
  return *texture_volume(std::array{probes, volume, array, bricks});
}

struct Row {
  std::string name;
  VolumeDesc volume;
};

inline std::vector<Row> payload_rows() {
  const auto probes = [](std::vector<NamedTexture> textures) { return *probe_volume(textures); };
  constexpr Grid kSmallGrid{3, 2, 2};
  return {
      {"probes",
       probes({{"color", ddgi_irradiance(kSmallGrid)}, {"vis", ddgi_visibility(kSmallGrid)}})},
      {"probes of engines",
       probes({{"color", probe_texture(Format::R16G16B16A16_SFLOAT, kSmallGrid, 6, 1)},
               {"distance", probe_texture(Format::R32G32_SFLOAT, kSmallGrid, 14, 1)},
               {"packed", probe_texture(Format::B10G11R11_UFLOAT_PACK32, kSmallGrid, 8, 0)},
               {"sh", probe_texture(Format::R8G8B8A8_SNORM, kSmallGrid, 2, 0)},
               {"state", probe_texture(Format::R8_UINT, kSmallGrid, 1, 0)},
               {"bc6h", probe_texture(Format::BC6H_UFLOAT_BLOCK, kSmallGrid, 2, 0)}})},
      {"textures", plain_volume()},
      {"irradiance vectors", *irradiance_vector_volume(kSmallGrid)},
      {"irradiance vectors in floats", *irradiance_vector_volume(kSmallGrid, true)},
      {"irradiance maps", *irradiance_map_volume({.width = 35, .height = 18})},
      {"irradiance maps by bases", *irradiance_map_volume({.width = 32,
                                                           .height = 20,
                                                           .way = MapWay::bases,
                                                           .format = Format::R16G16B16A16_SFLOAT,
                                                           .bases = 130})},
      {"irradiance maps in 10 bits",
       *irradiance_map_volume(
           {.width = 32, .height = 16, .format = Format::A2B10G10R10_UNORM_PACK32})},
      {"AO points", *ao_point_volume(30, 9, 4)},
      {"photons", *photon_volume(10, 64)},
      {"photons with shared exponents", *photon_volume(7, 64, PhotonForm::shared_exponent)},
      {"voxels", *voxel_volume(6)},
      {"voxels in halves", *voxel_volume(3, 4, VoxelForm::halves)},
      {"everything", scene_volume(10)},
  };
}

}  // namespace gicodec::test
