// Kind 7: which volumes there are, and where bricks stand.
#include <gicodec/irradiance_vectors.h>
#include <gicodec/voxels.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <cstring>
#include <vector>

namespace gicodec::test {
namespace {

std::array<std::byte, kBrickPlaceBytes> packed(const BrickPlace& place) {
  std::array<std::byte, kBrickPlaceBytes> bytes{};
  pack_brick_place(place, bytes);
  return bytes;
}

RC_GTEST_PROP(Voxels, AVolumeTellsWhatItWasMadeOf, ()) {
  const auto bricks = *rc::gen::inRange<std::uint32_t>(1, kMaxBlocks + 1);
  const auto side = *rc::gen::element<std::uint8_t>(4, 8);
  const auto form = *rc::gen::element(VoxelForm::shared_exponent, VoxelForm::halves);
  const auto volume = voxel_volume(bricks, side, form);
  RC_ASSERT(volume.ok());
  const TextureDesc& light = volume->groups.front().textures.back().desc;
  RC_ASSERT(*voxel_form(light.record) == form);
  RC_ASSERT(block_count(light) == bricks);
  RC_ASSERT(record_count(light.block) == kVoxelDirections * std::uint32_t{side} * side * side);
  std::vector<std::byte> bytes;
  RC_ASSERT(kVoxels.write(*volume, bytes) == Status::ok);
  const auto read = kVoxels.read(bytes);
  RC_ASSERT(read.ok());
  RC_ASSERT(same_but_layout(*read, *volume));
}

TEST(Voxels, NumbersOutOfRangeAreRefused) {
  EXPECT_EQ(voxel_volume(0).status(), Status::invalid_description);
  EXPECT_EQ(voxel_volume(kMaxBlocks + 1).status(), Status::invalid_description);
  for (const std::uint8_t side : std::array<std::uint8_t, 9>{0, 1, 2, 3, 5, 7, 9, 16, 255}) {
    EXPECT_EQ(voxel_volume(1, side).status(), Status::invalid_description) << +side;
  }
  EXPECT_EQ(voxel_volume(1, 4, static_cast<VoxelForm>(2)).status(), Status::invalid_description);
  EXPECT_EQ(voxel_form(Format::R8_UNORM).status(), Status::unsupported_format);
  std::vector<std::byte> bytes;
  EXPECT_EQ(kVoxels.write(*irradiance_vector_volume({1, 1, 1}), bytes),
            Status::invalid_description);
}

RC_GTEST_PROP(BrickPlace, ComesBack, ()) {
  const auto at = [] { return *rc::gen::inRange<std::uint32_t>(0, kMaxBrickSide); };
  const BrickPlace place{static_cast<std::uint8_t>(*rc::gen::inRange(0U, kMaxBrickLevel + 1)),
                         {at(), at(), at()}};
  RC_ASSERT(unpack_brick_place(packed(place)) == place);
}

RC_GTEST_PROP(BrickPlace, OfAnyBytesIsInRange, (std::array<std::uint8_t, 8> any)) {
  std::array<std::byte, kBrickPlaceBytes> bytes{};
  std::memcpy(bytes.data(), any.data(), any.size());
  const BrickPlace place = unpack_brick_place(bytes);
  RC_ASSERT(place.level <= kMaxBrickLevel);
  for (const std::uint32_t c : place.at) RC_ASSERT(c < kMaxBrickSide);
}

TEST(BrickPlace, HasItsBitsInTurn) {
  EXPECT_EQ(morton_key({1, 0, 0}), 1U);
  EXPECT_EQ(morton_key({0, 1, 0}), 2U);
  EXPECT_EQ(morton_key({0, 0, 1}), 4U);
  EXPECT_EQ(morton_key({2, 3, 1}), 0b011'110U);
  constexpr std::uint32_t kMax = kMaxBrickSide - 1;
  EXPECT_EQ(morton_key({kMax, kMax, kMax}), (std::uint64_t{1} << 54) - 1);
  const auto bytes = packed({3, {2, 0, 0}});
  EXPECT_EQ(bytes[0], std::byte{8});
  EXPECT_EQ(bytes[7], std::byte{3});
}

/// A parent comes with all of its children, in the order of their keys.
RC_GTEST_PROP(BrickPlace, ChildrenFollowEachOther, ()) {
  const auto at = [] { return *rc::gen::inRange<std::uint32_t>(0, kMaxBrickSide / 2); };
  const std::array<std::uint32_t, 3> parent{at(), at(), at()};
  for (unsigned child = 0; child < 8; ++child) {
    const std::uint64_t key =
        morton_key({2 * parent[0] + (child & 1), 2 * parent[1] + (child >> 1 & 1),
                    2 * parent[2] + (child >> 2)});
    RC_ASSERT(key == morton_key(parent) * 8 + child);
  }
}

TEST(Voxels, CoarserBricksMatterMore) {
  const auto rank = voxel_volume(1)->groups.front().rank;
  ASSERT_NE(rank, nullptr);
  float before = 0;
  for (std::uint8_t level = 0; level <= kMaxBrickLevel; ++level) {
    std::array<std::byte, 16> block{};
    pack_brick_place({level, {1, 2, 3}}, std::span(block).first<kBrickPlaceBytes>());
    EXPECT_EQ(rank(block), 0) << "free";
    block.back() = std::byte{1};
    EXPECT_GT(rank(block), before);
    before = rank(block);
  }
}

}  // namespace
}  // namespace gicodec::test
