// Where blocks stand in memory, and the checks of views.
#include "shapes.h"
#include "support.h"

#include "texture/view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

namespace gicodec {
namespace {

using namespace test;

TEST(Tiling, Names) {
  for (std::uint8_t i = 0; i < kTilingCount; ++i) {
    const auto tiling = static_cast<Tiling>(i);
    ASSERT_FALSE(to_string(tiling).empty());
    const auto back = tiling_from_string(to_string(tiling));
    ASSERT_TRUE(back.ok());
    EXPECT_EQ(*back, tiling);
  }
  EXPECT_EQ(to_string(Tiling::atlas_xy_z), "atlas_xy_z");
  EXPECT_TRUE(to_string(static_cast<Tiling>(kTilingCount)).empty());
  EXPECT_EQ(tiling_from_string("atlas").status(), Status::invalid_argument);
  EXPECT_EQ(tiling_from_string("").status(), Status::invalid_argument);
}

using Place = std::array<std::uint64_t, 4>;  // x, y, slice, block
Place place_of(const TextureDesc& desc, std::uint32_t block) {
  const auto origin = block_origin(desc, block);
  return {origin.x, origin.y, origin.slice, origin.block};
}

TEST(Layout, DocumentedPlaceOfABlock) {
  const std::uint64_t x = 2, y = 1, z = 3, block = x + 3 * (y + 4 * z);
  // 5×4×2 records: tiles of 5×4 in a slice, 2 slices deep.
  TextureDesc desc = bricks();
  desc.grid = {3, 4, 5};
  desc.block = {5, 4, 2};
  const auto at = [&](Tiling tiling) {
    desc.layout = tiling;
    return place_of(desc, static_cast<std::uint32_t>(block));
  };
  const auto size = [&](Tiling tiling) {
    desc.layout = tiling;
    return extent(desc);
  };
  EXPECT_EQ(at(Tiling::atlas_xy_z), (Place{5 * (x + 3 * y), 4 * z, 0, 0}));
  EXPECT_EQ(size(Tiling::atlas_xy_z), (Extent{5 * 12, 4 * 5, 2}));
  EXPECT_EQ(at(Tiling::atlas_xz_y), (Place{5 * (x + 3 * z), 4 * y, 0, 0}));
  EXPECT_EQ(size(Tiling::atlas_xz_y), (Extent{5 * 15, 4 * 4, 2}));
  EXPECT_EQ(at(Tiling::atlas_x_yz), (Place{5 * x, 4 * (y + 4 * z), 0, 0}));
  EXPECT_EQ(size(Tiling::atlas_x_yz), (Extent{5 * 3, 4 * 20, 2}));
  EXPECT_EQ(at(Tiling::slices_xz_y), (Place{5 * x, 4 * z, 2 * y, 0}));
  EXPECT_EQ(size(Tiling::slices_xz_y), (Extent{5 * 3, 4 * 5, 2 * 4}));
  EXPECT_EQ(at(Tiling::slices_xy_z), (Place{5 * x, 4 * y, 2 * z, 0}));
  EXPECT_EQ(size(Tiling::slices_xy_z), (Extent{5 * 3, 4 * 4, 2 * 5}));
  EXPECT_EQ(at(Tiling::blocks), (Place{0, 0, 0, block}));
  EXPECT_EQ(size(Tiling::blocks), (Extent{5, 4, 2 * 60}));
  EXPECT_EQ(at(Tiling::atlas_yz_x), (Place{5 * (y + 4 * z), 4 * x, 0, 0}));
  EXPECT_EQ(size(Tiling::atlas_yz_x), (Extent{5 * 20, 4 * 3, 2}));
  EXPECT_EQ(at(Tiling::slices_yx_z), (Place{5 * y, 4 * x, 2 * z, 0}));
  EXPECT_EQ(size(Tiling::slices_yx_z), (Extent{5 * 4, 4 * 3, 2 * 5}));
}

TEST(Layout, PaddingStandsAroundBlocksAlongAxesOfMoreThanOne) {
  // 5³ in memory around 4³, as hardware filters across the edge of a brick want it.
  TextureDesc desc = bricks();
  desc.grid = {3, 2, 2};
  desc.block = {4, 4, 4};
  desc.layout = Tiling::slices_xy_z;
  desc.layout.pad_after = 1;
  EXPECT_EQ(extent(desc), (Extent{15, 10, 10}));
  EXPECT_EQ(place_of(desc, 11), (Place{10, 5, 5, 0}));
  desc.layout.pad_before = 2;
  EXPECT_EQ(extent(desc), (Extent{21, 14, 14}));
  EXPECT_EQ(place_of(desc, 11), (Place{16, 9, 9, 0}));
  desc.layout.tiling = Tiling::blocks;
  EXPECT_EQ(extent(desc), (Extent{7, 7, 7 * 12}));
  EXPECT_EQ(place_of(desc, 11), (Place{2, 2, 2, 11}));
  desc.block = {4, 1, 1};
  EXPECT_EQ(extent(desc), (Extent{7, 1, 12}));
  EXPECT_EQ(place_of(desc, 11), (Place{2, 0, 0, 11}));
  // Before the guard band, too.
  TextureDesc probes = probe_texture(Format::R16_SFLOAT, {3, 2, 1}, 4);
  probes.layout.pad_before = 1;
  probes.layout.pad_after = 2;
  EXPECT_EQ(extent(probes), (Extent{6 * 9, 9, 1}));
  EXPECT_EQ(place_of(probes, 5), (Place{46, 1, 0, 0}));
}

TEST(Layout, SlotsOfAPoolStandInRowsAndSlices) {
  TextureDesc pool = bricks();
  pool.space = Space::pool;
  pool.model = Model::none;
  pool.grid = {17, 1, 1};
  pool.block = {4, 3, 2};
  pool.layout = Tiling::slices_xy_z;
  EXPECT_EQ(extent(pool), (Extent{17 * 4, 3, 2}));
  EXPECT_EQ(place_of(pool, 16), (Place{64, 0, 0, 0}));
  pool.layout.slots = {3, 2, 4};
  ASSERT_EQ(validate(pool), Status::ok);
  EXPECT_EQ(extent(pool), (Extent{12, 6, 8}));
  EXPECT_EQ(place_of(pool, 16), (Place{4, 3, 4, 0}));  // 16 = 1 + 3·(1 + 2·2).
  pool.layout.tiling = Tiling::atlas_xy_z;
  EXPECT_EQ(extent(pool), (Extent{24, 12, 2}));
  EXPECT_EQ(place_of(pool, 16), (Place{4 * 4, 2 * 3, 0, 0}));
  // An array has as many blocks as the pool has slots, wherever they would stand.
  pool.layout.tiling = Tiling::blocks;
  EXPECT_EQ(extent(pool), (Extent{4, 3, 34}));
  EXPECT_EQ(place_of(pool, 16), (Place{0, 0, 0, 16}));
}

TEST(Layout, WhatIsBeyondTheLastRecordIsNotInMemoryOfAMap) {
  // A 2D map of 13×9 records in tiles of 8×8.
  TextureDesc map = probe_texture(Format::R8_UNORM, {2, 2, 1}, 8, 0, Tiling::slices_xy_z);
  map.records = {13, 9, 1};
  ASSERT_EQ(validate(map), Status::ok);
  EXPECT_EQ(extent(map), (Extent{13, 9, 1}));
  EXPECT_EQ(texture_bytes(map), 13U * 9U);
  EXPECT_EQ(block_inside(map, 0), (BlockShape{8, 8, 1}));
  EXPECT_EQ(block_inside(map, 1), (BlockShape{5, 8, 1}));
  EXPECT_EQ(block_inside(map, 2), (BlockShape{8, 1, 1}));
  EXPECT_EQ(block_inside(map, 3), (BlockShape{5, 1, 1}));
  // Elsewhere whole blocks have room, as they have in packets.
  map.layout = Tiling::atlas_xy_z;
  EXPECT_EQ(extent(map), (Extent{32, 8, 1}));
  EXPECT_EQ(block_inside(map, 3), (BlockShape{5, 1, 1}));
  // A 3D texture in bricks.
  TextureDesc volume = bricks();
  volume.layout = Tiling::slices_xy_z;
  volume.records = {20, 16, 9};
  ASSERT_EQ(validate(volume), Status::ok);
  EXPECT_EQ(extent(volume), (Extent{20, 16, 9}));
  EXPECT_EQ(block_inside(volume, block_count(volume) - 1), (BlockShape{4, 8, 1}));
}

/// Every record of every block has a place of its own, inside the extent.
TEST(Layout, RecordsNeverShareAPlace) {
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    const auto desc = any_desc(random, 4000);
    const auto size = extent(desc);
    const bool array = desc.layout.tiling == Tiling::blocks;
    const std::uint64_t slices = array ? size.slices / block_count(desc) : size.slices;
    std::set<std::array<std::uint64_t, 4>> places;
    std::size_t records = 0;
    for (std::uint32_t block = 0; block < block_count(desc); ++block) {
      const auto origin = block_origin(desc, block);
      const auto inside = block_inside(desc, block);
      ASSERT_EQ(origin.block, array ? block : 0) << desc;
      for (std::uint64_t z = 0; z < inside.z; ++z) {
        for (std::uint64_t y = 0; y < inside.y + 2U * desc.guard_band; ++y) {
          for (std::uint64_t x = 0; x < inside.x + 2U * desc.guard_band; ++x, ++records) {
            ASSERT_TRUE(origin.x + x < size.width && origin.y + y < size.height &&
                        origin.slice + z < slices)
                << desc;
            places.insert({origin.x + x, origin.y + y, origin.slice + z, origin.block});
          }
        }
      }
    }
    ASSERT_EQ(places.size(), records) << desc;
    const bool exact = desc.layout.pad_before + desc.layout.pad_after == 0 &&
                       desc.layout.slots == Grid{} && desc.records == Grid{};
    if (exact) {
      ASSERT_EQ(texture_bytes(desc), records * desc.record.bytes) << desc;
    }
  }
}

TEST(View, ExactSizesFitAndOneByteLessDoesNot) {
  Random random(2);
  for (int round = 0; round < 300; ++round) {
    const auto desc = any_desc(random);
    const Texture texture(desc, random() % 40, random() % 300, random() % 100);
    auto view = texture.view();
    ASSERT_TRUE(check_view(desc, view).ok()) << desc;
    view.bytes = view.bytes.first(view.bytes.size() - 1);
    ASSERT_EQ(check_view(desc, view).status(), Status::view_too_small) << desc;
    view.bytes = {};
    ASSERT_EQ(check_view(desc, view).status(), Status::view_too_small) << desc;
  }
}

TEST(View, PitchZeroIsTightAndSmallerPitchesAreRefused) {
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    const auto desc = any_desc(random);
    const auto size = extent(desc);
    const std::size_t row = size.width * desc.record.bytes;
    const Exact buffer(texture_bytes(desc));
    ASSERT_TRUE(check_view(desc, ConstTextureView(buffer.span())).ok()) << desc;
    ASSERT_EQ(check_view(desc, ConstTextureView(buffer.span(), row - 1)).status(),
              row == 1 ? Status::ok : Status::view_too_small)
        << desc;
    const std::size_t blocks = desc.layout.tiling == Tiling::blocks ? block_count(desc) : 1;
    const std::size_t slices = size.slices / blocks, slice = row * size.height;
    if (slices > 1) {
      ASSERT_EQ(check_view(desc, ConstTextureView(buffer.span(), row, slice - 1)).status(),
                slice == 1 ? Status::ok : Status::view_too_small)
          << desc;
    }
    if (blocks > 1) {
      ASSERT_EQ(
          check_view(desc, ConstTextureView(buffer.span(), 0, 0, slice * slices - 1)).status(),
          slice * slices == 1 ? Status::ok : Status::view_too_small)
          << desc;
      ASSERT_EQ(check_view(desc, ConstTextureView(buffer.span(), 0, 0, slice * slices)).status(),
                Status::ok)
          << desc;
    }
  }
}

TEST(View, HugePitchesDoNotWrapAround) {
  const std::size_t huge[] = {
      SIZE_MAX,         SIZE_MAX - 1, SIZE_MAX / 2,         SIZE_MAX / 2 + 1,
      SIZE_MAX / 3 + 1, SIZE_MAX / 7, std::size_t{1} << 32, std::size_t{1} << 63};
  const Exact buffer(4096);
  for (const auto pitch : huge) {
    for (const auto tiling : {Tiling::atlas_xy_z, Tiling::slices_xy_z}) {
      const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {2, 2, 3}, 2, 1, tiling);
      EXPECT_EQ(check_view(desc, ConstTextureView(buffer.span(), pitch)).status(),
                Status::view_too_small);
      EXPECT_EQ(check_view(desc, ConstTextureView(buffer.span(), pitch, pitch)).status(),
                Status::view_too_small);
      EXPECT_EQ(check_view(desc, ConstTextureView(buffer.span(), 0, pitch)).ok(),
                extent(desc).slices == 1);
      EXPECT_TRUE(check_view(desc, ConstTextureView(buffer.span(), 0, 0, pitch)).ok());
    }
    const TextureDesc array = probe_texture(Format::R16_SFLOAT, {2, 2, 3}, 2, 1, Tiling::blocks);
    // Blocks of one slice follow one another at the slice's pitch, unless they have their own.
    EXPECT_EQ(check_view(array, ConstTextureView(buffer.span(), 0, pitch)).status(),
              Status::view_too_small);
    EXPECT_TRUE(check_view(array, ConstTextureView(buffer.span(), 0, pitch, 40)).ok());
    EXPECT_EQ(check_view(array, ConstTextureView(buffer.span(), 0, 0, pitch)).status(),
              Status::view_too_small);
  }
}

// With one row or one slice its pitch is never added, however large.
TEST(View, UnusedPitchesMayBeAnything) {
  const TextureDesc desc = probe_texture(Format::R32_SFLOAT, {4, 1, 1}, 1, 0, Tiling::slices_xy_z);
  Exact buffer(16);
  Random random(4);
  std::ranges::copy(noise(random, 16), buffer.span().begin());
  auto encoder = Encoder::create(desc);
  auto decoder = Decoder::create(desc);
  ASSERT_TRUE(encoder.ok() && decoder.ok());
  for (const std::size_t pitch : {SIZE_MAX, SIZE_MAX / 2 + 3}) {
    const auto packet = encoder->encode({buffer.span(), pitch, pitch}, Selection::all());
    ASSERT_TRUE(packet.ok()) << packet.status();
    ASSERT_TRUE(encoder->encode({buffer.span(), pitch, pitch}).ok());
    encoder->request_keyframe();
    Exact out(16);
    ASSERT_EQ(decoder->decode(*packet, TextureView{out.span(), pitch, pitch}), Status::ok);
    EXPECT_TRUE(std::ranges::equal(out.span(), buffer.span()));
  }
}

// Several volumes in one atlas: each is a view of its part, which ends where its last record does.
TEST(View, PartsOfAnAtlas) {
  Random random(5);
  TextureDesc whole = bricks();
  whole.grid = {4, 2, 2};
  whole.block = {3, 3, 3};
  whole.layout = Tiling::slices_xy_z;
  whole.layout.pad_after = 1;
  TextureDesc part = whole;
  part.grid = {2, 1, 2};
  const auto size = extent(whole), small = extent(part);
  const std::size_t row = size.width * 4, slice = size.height * row;
  Exact atlas(noise(random, texture_bytes(whole)));
  const Bytes before(atlas.span().begin(), atlas.span().end());
  // Of blocks (2, 1, 0) and on: the atlas ends with the part, padding included.
  const std::size_t first = 4 * row + 8 * 4;
  const std::size_t bytes = (small.slices - 1) * slice + (small.height - 1) * row + small.width * 4;
  ASSERT_EQ(first + bytes, atlas.span().size());
  const TextureView view{atlas.span().subspan(first), row, slice};
  ASSERT_TRUE(check_view(part, view).ok());

  Texture source(part);
  source.fill(Fill::noise, random);
  auto encoder = Encoder::create(part, {.backend = "zstd"});
  auto decoder = Decoder::create(part);
  ASSERT_TRUE(encoder.ok() && decoder.ok());
  ASSERT_EQ(decoder->decode(*encoder->encode(std::as_const(source).view()), view), Status::ok);
  std::size_t at = 0;
  for (std::size_t z = 0; z < size.slices; ++z) {
    for (std::size_t y = 0; y < size.height; ++y) {
      for (std::size_t x = 0; x < size.width; ++x, at += 4) {
        const bool padding = x % 4 == 3 || y % 4 == 3 || z % 4 == 3;
        const bool inside = x >= 8 && y >= 4;
        const auto now = atlas.span().subspan(at, 4);
        if (padding || !inside) {
          ASSERT_TRUE(std::ranges::equal(now, std::span(before).subspan(at, 4)));
        } else {
          const auto block = static_cast<std::uint32_t>((x - 8) / 4 + 2 * (z / 4));
          const auto record =
              source.record(block, static_cast<std::uint32_t>(x % 4),
                            static_cast<std::uint32_t>(y % 4), static_cast<std::uint32_t>(z % 4));
          ASSERT_TRUE(std::ranges::equal(now, record));
        }
      }
    }
  }
  // And out of the atlas again.
  auto again = Encoder::create(part, {.backend = "raw"});
  auto copy = Decoder::create(part);
  ASSERT_EQ(copy->decode(*again->encode(view)), Status::ok);
  EXPECT_EQ(contents(*copy), source.blocks());
}

TEST(View, ArraysOfBlocksWithRoomBetweenThem) {
  Random random(6);
  TextureDesc desc = bricks();
  desc.block = {3, 2, 2};
  desc.layout = Tiling::blocks;
  Texture texture(desc, 5, 7, 11);
  texture.fill(Fill::noise, random);
  const auto view = std::as_const(texture).view();
  ASSERT_EQ(view.row_pitch, 17U);
  ASSERT_EQ(view.slice_pitch, 2 * 17U + 7U);
  ASSERT_EQ(view.block_pitch, 2 * 41U + 11U);
  // Record (2, 1, 1) of block 4 stands where the pitches say.
  EXPECT_TRUE(std::ranges::equal(view.bytes.subspan(4 * 93 + 41 + 17 + 2 * 4, 4),
                                 texture.record(4, 2, 1, 1)));
  auto encoder = Encoder::create(desc, {.backend = "lz4"});
  auto decoder = Decoder::create(desc);
  Texture out(desc, 1, 0, 3);
  ASSERT_EQ(decoder->decode(*encoder->encode(view), out.view()), Status::ok);
  EXPECT_EQ(out.blocks(), texture.blocks());
  EXPECT_TRUE(out.padding_untouched());
}

}  // namespace
}  // namespace gicodec
