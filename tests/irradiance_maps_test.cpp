// Kind 4: which volumes there are.
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
  desc.way = static_cast<MapWay>(in(0, 1));
  desc.width = in(1, kMaxMapSide);
  desc.height = in(1, kMaxMapSide);
  desc.format = kFormats[in(0, 3)];
  if (desc.way == MapWay::bases) desc.bases = in(1, kMaxMapBases);
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
  EXPECT_TRUE(refused({.way = static_cast<MapWay>(2)}));
  EXPECT_TRUE(refused({.bases = 1})) << "a map has none";
  EXPECT_TRUE(refused({.way = MapWay::bases}));
  EXPECT_TRUE(refused({.way = MapWay::bases, .bases = kMaxMapBases + 1}));
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
