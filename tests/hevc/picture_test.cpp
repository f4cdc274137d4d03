// Records ↔ planes, without any codec.
#include "backend/hevc/picture.h"
#include "shapes.h"

#include <gicodec/probes.h>
#include <gicodec/textures.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <random>

namespace gicodec::hevc {
namespace {

std::vector<std::byte> random_bytes(std::size_t size, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::byte> bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

bool is_10_bit(Format format) {
  return format == Format::A2R10G10B10_UNORM_PACK32 || format == Format::A2B10G10R10_UNORM_PACK32;
}

RC_GTEST_PROP(HevcPicture, InverseOfForwardIsIdentity, (std::uint64_t seed)) {
  test::Random shapes(seed);
  const TextureDesc desc = test::any_desc(shapes);
  const auto packing = *rc::gen::element(HevcPacking::paper, HevcPacking::planes);
  const auto layout = *rc::gen::element(HevcLayout::atlas, HevcLayout::packed);
  const std::uint8_t size_class =
      layout == HevcLayout::packed ? size_class_of(desc, block_count(desc)) : std::uint8_t{0};
  const auto shape = frame_shape(desc, packing, layout, size_class);
  RC_PRE(shape.ok());
  RC_ASSERT(shape->picture.width % 8 == 0);
  RC_ASSERT(shape->picture.height % 8 == 0);

  std::vector<std::uint32_t> places(block_count(desc));
  for (std::uint32_t i = 0; i < places.size(); ++i) places[i] = i;
  auto blocks =
      random_bytes(places.size() * block_bytes(desc), *rc::gen::arbitrary<std::uint32_t>());
  if (is_10_bit(desc.record.format)) {
    for (std::size_t i = 3; i < blocks.size(); i += 4) blocks[i] &= std::byte{0x3F};
  }
  std::vector<std::byte> raster(raster_bytes(desc, *shape)), raster_back(raster.size());
  blocks_to_raster(desc, *shape, places, blocks, raster);
  Picture picture;
  raster_to_picture(best_isa(), desc, *shape, raster, picture);
  for (std::size_t i = 0; i < picture.samples.size() && shape->picture.bit_depth > 8; i += 2) {
    std::uint16_t sample;
    std::memcpy(&sample, &picture.samples[i], sizeof sample);
    RC_ASSERT(sample < (1U << shape->picture.bit_depth));
  }
  picture_to_raster(best_isa(), desc, *shape, picture, raster_back);
  RC_ASSERT(raster_back == raster);
  std::vector<std::byte> blocks_back(blocks.size());
  raster_to_blocks(desc, *shape, places, raster_back, blocks_back);
  RC_ASSERT(blocks_back == blocks);
}

TEST(HevcPicture, LumaComesBackWithinItsRounding) {
  const TextureDesc desc = map_texture(Format::A2B10G10R10_UNORM_PACK32, {64, 64, 1}, {16, 16, 1});
  const auto shape = frame_shape(desc, HevcPacking::luma, HevcLayout::atlas, 0);
  ASSERT_TRUE(shape.ok());
  EXPECT_EQ(shape->picture.bit_depth, 10);
  auto raster = random_bytes(raster_bytes(desc, *shape), 1);
  const std::uint32_t corners[] = {
      0, 1023, 1023U << 10, 1023U << 20, 1023U << 20 | 1023, (1U << 30) - 1};
  std::memcpy(raster.data(), corners, sizeof corners);
  std::vector<std::byte> back(raster.size());
  Picture picture;
  raster_to_picture(best_isa(), desc, *shape, raster, picture);
  picture_to_raster(best_isa(), desc, *shape, picture, back);
  for (std::size_t at = 0; at < raster.size(); at += 4) {
    std::uint32_t was = 0, is = 0;
    std::memcpy(&was, &raster[at], 4);
    std::memcpy(&is, &back[at], 4);
    for (const unsigned shift : {0U, 10U, 20U}) {
      const int a = static_cast<int>(was >> shift & 1023), b = static_cast<int>(is >> shift & 1023);
      ASSERT_LE(std::abs(a - b), 2) << at / 4 << " " << shift;
    }
  }
}

// Whatever samples a damaged stream gives, no 10-bit texel has bits outside its codes.
TEST(HevcPicture, DamagedSamplesStayInRange) {
  const TextureDesc desc = ddgi_irradiance({2, 2, 1});
  const auto shape = frame_shape(desc, HevcPacking::planes, HevcLayout::atlas, 0);
  ASSERT_TRUE(shape.ok());
  Picture picture;
  picture.reset(shape->picture);
  picture.samples = random_bytes(picture.samples.size(), 5);
  for (std::size_t i = 1; i < picture.samples.size(); i += 2) picture.samples[i] &= std::byte{0x0F};
  std::vector<std::byte> raster(raster_bytes(desc, *shape));
  picture_to_raster(best_isa(), desc, *shape, picture, raster);
  for (std::size_t i = 3; i < raster.size(); i += 4) {
    EXPECT_EQ(raster[i] & std::byte{0xC0}, std::byte{0});
  }
}

TEST(HevcPicture, AtlasFollowsThePaper) {
  // Tile column x + nx·y, tile row z: block 7 of a 2×3×2 grid is x = 1, y = 0, z = 1.
  const TextureDesc desc =
      probe_texture(Format::R8G8B8A8_UNORM, {2, 3, 2}, 4, 1, Tiling::slices_xz_y);
  const auto shape = frame_shape(desc, HevcPacking::planes, HevcLayout::atlas, 0);
  ASSERT_TRUE(shape.ok());
  EXPECT_EQ(shape->columns, 6U);
  EXPECT_EQ(shape->rows, 2U);
  std::vector<std::byte> raster(raster_bytes(desc, *shape));
  const std::vector<std::byte> block(block_bytes(desc), std::byte{0xAB});
  const std::uint32_t place = 7;
  blocks_to_raster(desc, *shape, {&place, 1}, block, raster);
  EXPECT_EQ(raster[(4 * shape->width + 4) * 4], std::byte{0xAB});
  EXPECT_EQ(raster[(4 * shape->width + 3) * 4], std::byte{0});
  EXPECT_EQ(std::ranges::count(raster, std::byte{0xAB}), 64);
}

TEST(HevcPicture, WideGridsWrapAndHugeOnesAreRefused) {
  const TextureDesc wide =
      probe_texture(Format::R16G16_SFLOAT, {3000, 1, 2}, 16, 1, Tiling::atlas_xy_z);
  const auto shape = frame_shape(wide, HevcPacking::planes, HevcLayout::atlas, 0);
  ASSERT_TRUE(shape.ok());
  EXPECT_LE(shape->picture.width, kMaxAtlasWidth);
  EXPECT_GE(shape->columns * shape->rows, 6000U);
  const TextureDesc huge =
      probe_texture(Format::R32G32B32A32_SFLOAT, {256, 256, 64}, 64, 1, Tiling::atlas_xy_z);
  for (const auto layout : {HevcLayout::atlas, HevcLayout::packed}) {
    const std::uint8_t size_class =
        layout == HevcLayout::packed ? size_class_of(huge, block_count(huge)) : std::uint8_t{0};
    EXPECT_EQ(frame_shape(huge, HevcPacking::paper, layout, size_class).status(),
              Status::limit_exceeded);
  }
}

}  // namespace
}  // namespace gicodec::hevc
