// Kind 4: which volumes there are, and what frames of a video name.
#include <gicodec/irradiance_maps.h>
#include <gicodec/irradiance_vectors.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <cstring>
#include <vector>

namespace gicodec::test {
namespace {

constexpr std::array<Format, 4> kFormats{
    Format::E5B9G9R9_UFLOAT_PACK32, Format::B10G11R11_UFLOAT_PACK32, Format::R16G16B16A16_SFLOAT,
    Format::A2B10G10R10_UNORM_PACK32};

RC_GTEST_PROP(IrradianceMaps, AVolumeTellsWhatItWasMadeOf, ()) {
  const auto in = [](std::uint32_t least, std::uint32_t most) {
    return *rc::gen::inRange(least, most + 1);
  };
  IrradianceMapDesc desc;
  desc.way = static_cast<MapWay>(in(0, 2));
  desc.width = in(1, kMaxMapSide);
  desc.height = in(1, kMaxMapSide);
  desc.format = kFormats[in(0, 3)];
  if (desc.way == MapWay::bases) desc.bases = in(1, kMaxMapBases);
  if (desc.way == MapWay::video) {
    desc.width = (desc.width + kMapTile - 1) / kMapTile * kMapTile;
    desc.height = (desc.height + kMapTile - 1) / kMapTile * kMapTile;
    desc.format = Format::A2B10G10R10_UNORM_PACK32;
    desc.pages = in(1, kMaxMapPages);
    desc.frames = in(1, kMaxMapFrames);
  }
  const auto volume = irradiance_map_volume(desc);
  RC_ASSERT(volume.ok());
  const auto again = irradiance_map_desc(*volume);
  RC_ASSERT(again.ok());
  desc.bases = (desc.bases + 63) / 64 * 64;
  RC_ASSERT(*again == desc);
  std::vector<std::byte> bytes;
  RC_ASSERT(kIrradianceMaps.write(*volume, bytes) == Status::ok);
  const auto read = kIrradianceMaps.read(bytes);
  RC_ASSERT(read.ok());
  RC_ASSERT(same_but_layout(*read, *volume));
}

TEST(IrradianceMaps, NumbersOutOfRangeAreRefused) {
  const auto refused = [](const IrradianceMapDesc& desc) {
    return irradiance_map_volume(desc).status() == Status::invalid_description;
  };
  EXPECT_TRUE(refused({.width = 0}));
  EXPECT_TRUE(refused({.height = kMaxMapSide + 1}));
  EXPECT_TRUE(refused({.format = Format::R8G8B8A8_UNORM}));
  EXPECT_TRUE(refused({.way = static_cast<MapWay>(3)}));
  EXPECT_TRUE(refused({.bases = 1})) << "a map has none";
  EXPECT_TRUE(refused({.way = MapWay::bases}));
  EXPECT_TRUE(refused({.way = MapWay::bases, .bases = kMaxMapBases + 1}));
  EXPECT_TRUE(refused({.way = MapWay::bases, .bases = 1, .frames = 1}));
  const Format codes = Format::A2B10G10R10_UNORM_PACK32;
  EXPECT_FALSE(refused({.way = MapWay::video, .format = codes, .pages = 1, .frames = 1}));
  EXPECT_TRUE(refused({.way = MapWay::video, .format = codes, .frames = 1}));
  EXPECT_TRUE(refused({.way = MapWay::video, .pages = 1, .frames = 1})) << "another format";
  EXPECT_TRUE(
      refused({.width = 24, .way = MapWay::video, .format = codes, .pages = 1, .frames = 1}))
      << "no whole tiles";
}

TEST(IrradianceMaps, OtherVolumesAreNone) {
  EXPECT_EQ(irradiance_map_desc({}).status(), Status::invalid_description);
  EXPECT_EQ(irradiance_map_desc(*irradiance_vector_volume({2, 2, 2})).status(),
            Status::invalid_description);
  VolumeDesc volume = *irradiance_map_volume({.way = MapWay::bases, .bases = 64});
  volume.groups[1].textures[0].name = "other";
  EXPECT_EQ(irradiance_map_desc(volume).status(), Status::invalid_description);
  volume = *irradiance_map_volume({});
  volume.kind = kKindIrradianceVectors;
  EXPECT_EQ(irradiance_map_desc(volume).status(), Status::invalid_description);
}

/// What a frame of that contents names, at most `room` of it; and how many in all.
struct Named {
  std::vector<std::uint32_t> pages;
  std::size_t count = 0;
};
Named named(std::array<std::uint32_t, 5> frame, std::size_t room) {
  const VolumeDesc volume = *irradiance_map_volume({.way = MapWay::video,
                                                    .format = Format::A2B10G10R10_UNORM_PACK32,
                                                    .pages = 100,
                                                    .frames = 2});
  Named out;
  out.pages.assign(room, 12345);
  out.count = volume.groups[1].dependencies(std::as_bytes(std::span(frame)), out.pages);
  return out;
}

TEST(IrradianceMaps, AFrameNamesItsPagesAndThoseBackToItsKeyframe) {
  const Named two = named({7, 2, 1500, 4, 5}, 8);
  EXPECT_EQ(two.count, 5U);
  EXPECT_EQ(two.pages, (std::vector<std::uint32_t>{8, 7, 6, 5, 4, 12345, 12345, 12345}));
  EXPECT_EQ(named({7, 2, 1500, 4, 2}, 2).pages, (std::vector<std::uint32_t>{8, 7}));
  EXPECT_EQ(named({0, 0, 0, 0, 0}, 2).count, 0U);
}

TEST(IrradianceMaps, NamesOfAnyFrameAreBounded) {
  constexpr std::uint32_t kAll = 0xFFFFFFFFU;
  const Named many = named({kAll, kAll, kAll, kAll, kAll}, 16);
  EXPECT_EQ(many.count, kMaxMapPages);
  EXPECT_EQ(many.pages.size(), 16U);
}

TEST(IrradianceMaps, DescriptionsOfOtherFormatsAreCorrupt) {
  std::vector<std::byte> bytes;
  ASSERT_EQ(kIrradianceMaps.write(*irradiance_map_volume({.width = 5, .height = 6}), bytes),
            Status::ok);
  ASSERT_EQ(bytes.size(), 4U);
  bytes[2] = std::byte{static_cast<std::uint8_t>(Format::R8_UNORM)};
  EXPECT_EQ(kIrradianceMaps.read(bytes).status(), Status::corrupt);
}

}  // namespace
}  // namespace gicodec::test
