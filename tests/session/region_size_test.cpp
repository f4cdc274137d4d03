// Regions are by the size of blocks where nobody says how large they are.
#include "session/server/region_size.h"
#include "payload_rows.h"

#include <gicodec/server.h>
#include <gicodec/textures.h>

#include <gtest/gtest.h>

namespace gicodec {
namespace {

TEST(RegionSize, ProbesAndTheirLargerRelatives) {
  const auto probes = [](Format color, Format visibility) {
    const std::vector<NamedTexture> textures{
        {"color", probe_texture(color, {16, 8, 16}, 8, 1)},
        {"vis", probe_texture(visibility, {16, 8, 16}, 16, 1)}};
    return usual_region(*probe_volume(textures));
  };
  const Grid usual{4, 4, 4};
  EXPECT_EQ(probes(Format::A2B10G10R10_UNORM_PACK32, Format::R16G16_SFLOAT), usual);
  EXPECT_EQ(probes(Format::R16G16B16A16_SFLOAT, Format::R32G32_SFLOAT), usual);
}

TEST(RegionSize, BlocksOfOneRegionAreBounded) {
  for (const test::Row& row : test::payload_rows()) {
    const Grid region = usual_region(row.volume);
    ASSERT_GE(std::min({region.x, region.y, region.z}), 1U) << row.name;
    ASSERT_LE(std::max({region.x, region.y, region.z}), kMaxGridSide) << row.name;
    const std::size_t blocks = std::size_t{region.x} * region.y * region.z;
    for (const TextureGroup& group : row.volume.groups) {
      std::size_t bytes = 0;
      for (const NamedTexture& texture : group.textures) {
        bytes = (group.bundled ? bytes : 0) + block_bytes(texture.desc);
        EXPECT_TRUE(blocks == 1 || blocks * bytes <= std::size_t{192} << 10) << row.name;
      }
    }
  }
}

TEST(RegionSize, LargeSlotsAreARegionEach) {
  VolumeDesc volume;
  volume.kind = 200;
  volume.groups = {{}};
  volume.groups[0].textures = {
      {"large", pool_texture(Format::R32G32B32A32_SFLOAT, 32, {64, 64, 4})}};
  EXPECT_EQ(usual_region(volume), (Grid{1, 1, 1}));
  volume.groups[0].textures[0].desc = pool_texture(Format::R32_UINT, 1U << 16, {7, 1, 1});
  EXPECT_EQ(usual_region(volume), (Grid{4096, 1, 1}));
}

/// Also where no side is left to halve.
TEST(RegionSize, LargeBlocksOfAGridAreARegionEach) {
  VolumeDesc volume;
  volume.kind = 200;
  volume.groups = {{}};
  volume.groups[0].textures = {
      {"large", map_texture(Format::R32G32B32A32_SFLOAT, {256, 384, 1}, {128, 128, 1})}};
  EXPECT_EQ(usual_region(volume), (Grid{1, 1, 1}));
}

/// A client is told the volume's own.
TEST(RegionSize, OfAServer) {
  auto server = Server::create();
  ASSERT_TRUE(server);
  for (const test::Row& row : test::payload_rows()) {
    if (find_kind(row.volume.kind) == nullptr) continue;
    const Grid grid = row.volume.groups[0].textures[0].desc.grid;
    ASSERT_TRUE(server->add_volume(row.name, row.volume, {grid})) << row.name;
  }
}

}  // namespace
}  // namespace gicodec
