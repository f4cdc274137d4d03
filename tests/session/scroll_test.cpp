// Camera-locked volumes: which blocks enter, where blocks stand, and how entering planes are sent.
#include "support.h"
#include "volumes.h"

#include <gicodec/volume.h>
#include "session/server/distributor.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace gicodec {
namespace {

using namespace test;

VolumeGeometry random_volume(Random& random) {
  VolumeGeometry volume;
  volume.grid = {pick(random, 1, 6), pick(random, 1, 6), pick(random, 1, 6)};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    volume.scroll[axis] = static_cast<std::int32_t>(pick(random, 0, 40)) - 20;
    volume.spacing[axis] = 0.25F * static_cast<float>(pick(random, 1, 8));
    volume.origin[axis] = static_cast<float>(pick(random, 0, 20)) - 10;
  }
  return volume;
}

std::uint32_t blocks_of(const VolumeGeometry& volume) {
  return volume.grid.x * volume.grid.y * volume.grid.z;
}

RC_GTEST_PROP(Scroll, BlocksStandInEveryCellOnce, (std::uint64_t seed)) {
  Random random(seed);
  const VolumeGeometry volume = random_volume(random);
  const std::array sides{volume.grid.x, volume.grid.y, volume.grid.z};
  std::set<Position> positions;
  for (std::uint32_t block = 0; block < blocks_of(volume); ++block) {
    const Position p = block_position(volume, block);
    positions.insert(p);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto cell = std::lround((p[axis] - volume.origin[axis]) / volume.spacing[axis]);
      RC_ASSERT(cell >= volume.scroll[axis]);
      RC_ASSERT(cell < volume.scroll[axis] + static_cast<long>(sides[axis]));
    }
  }
  RC_ASSERT(positions.size() == blocks_of(volume));
}

RC_GTEST_PROP(Scroll, ByCellIsTheOrderOfPositions, (std::uint64_t seed)) {
  Random random(seed);
  const VolumeGeometry volume = random_volume(random);
  auto expected = blocks_by_cell(volume);
  const auto from_z_to_x = [&](std::uint32_t block) {
    const Position p = block_position(volume, block);
    return Position{p[2], p[1], p[0]};
  };
  std::ranges::sort(expected, {}, from_z_to_x);
  RC_ASSERT(blocks_by_cell(volume) == expected);
  RC_ASSERT(std::set<std::uint32_t>(expected.begin(), expected.end()).size() == blocks_of(volume));
}

RC_GTEST_PROP(Scroll, ThoseThatEnterAreThoseThatMove, (std::uint64_t seed)) {
  Random random(seed);
  const VolumeGeometry before = random_volume(random);
  VolumeGeometry after = before;
  for (auto& cells : after.scroll) cells += static_cast<std::int32_t>(pick(random, 0, 10)) - 5;
  std::vector<std::uint32_t> moved;
  for (std::uint32_t block = 0; block < blocks_of(before); ++block) {
    if (block_position(before, block) != block_position(after, block)) moved.push_back(block);
  }
  RC_ASSERT(entering_blocks(before.grid, before.scroll, after.scroll) == moved);
}

RC_GTEST_PROP(Scroll, ShadingProbesSurroundThePoint, (std::uint64_t seed)) {
  Random random(seed);
  const VolumeGeometry volume = random_volume(random);
  const std::array sides{volume.grid.x, volume.grid.y, volume.grid.z};
  Position point{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // Somewhere inside, off the cells' faces.
    const auto cell = pick(random, 0, std::max(2U, sides[axis]) - 2);
    point[axis] = volume.origin[axis] +
                  volume.spacing[axis] *
                      (static_cast<float>(volume.scroll[axis]) + static_cast<float>(cell) + 0.375F);
  }
  BlockMask mask(blocks_of(volume), 0);
  add_shading_probes(volume, std::span(&point, 1), mask);
  for (std::uint32_t block = 0; block < mask.size(); ++block) {
    const Position p = block_position(volume, block);
    bool near = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      near = near && std::abs(p[axis] - point[axis]) < volume.spacing[axis];
    }
    RC_ASSERT((mask[block] != 0) == near);
  }
}

TEST(Scroll, FollowsTheViewer) {
  VolumeGeometry volume{{5, 4, 8}, {1, 2, 3}, {2, 1, 0.5F}};
  volume.scroll = scroll_to(volume, {101, 2, -47});
  Position middle{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::array<float, 3> half{2, 1.5F, 3.5F};
    middle[axis] = volume.origin[axis] +
                   (static_cast<float>(volume.scroll[axis]) + half[axis]) * volume.spacing[axis];
  }
  EXPECT_LE(std::abs(middle[0] - 101), 1.0F);
  EXPECT_LE(std::abs(middle[1] - 2), 0.5F);
  EXPECT_LE(std::abs(middle[2] + 47), 0.25F);
  const Scroll far = scroll_to(volume, {1e30F, -1e30F, 0});
  EXPECT_EQ(far[0], kMaxScroll);
  EXPECT_EQ(far[1], -kMaxScroll);
  EXPECT_EQ(validate(volume), Status::ok);
}

TEST(Scroll, EnteringPlanesAreFreshAndOthersUpdates) {
  const VolumeGeometry volume{{4, 3, 4}};
  const TextureDesc desc = ddgi_irradiance(volume.grid);
  auto distributor = Distributor::create();
  ASSERT_TRUE(distributor.ok());
  ASSERT_TRUE(distributor->add_volume(probes_of({{"color", desc}}), volume).ok());
  const auto client = distributor->connect();
  ASSERT_TRUE(client.ok());
  ASSERT_EQ(distributor->set_visible(*client, 0, BlockMask(48, 1)), Status::ok);
  Random random(1);
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  const auto publish = [&] { return distributor->publish(0, 0, std::as_const(texture).view()); };
  ASSERT_EQ(publish(), Status::ok);
  ASSERT_EQ(distributor->update(), Status::ok);
  auto decoder = Decoder::create(desc);
  ASSERT_TRUE(decoder.ok());
  ASSERT_EQ(decoder->decode(*distributor->packets(*client)[0].packet), Status::ok);

  ASSERT_EQ(distributor->scroll(0, {1, 0, 0}), Status::ok);
  const auto entered = entering_blocks(volume.grid, {}, {1, 0, 0});
  ASSERT_EQ(entered.size(), 12U);
  for (const auto block : entered) texture.fill_block(block, Fill::noise, random);
  texture.fill_block(1, Fill::noise, random);  // Changes, but stays where it is.
  for (std::uint32_t block = 0; block < 48; ++block) texture.fill_band(block);
  ASSERT_EQ(publish(), Status::ok);
  ASSERT_EQ(distributor->update(), Status::ok);
  const auto packets = distributor->packets(*client);
  ASSERT_EQ(packets.size(), 2U);
  EXPECT_FALSE(is_intra(peek(*packets[0].packet)->type));
  EXPECT_EQ(peek(*packets[0].packet)->blocks, 1U);
  EXPECT_EQ(peek(*packets[1].packet)->type, PacketType::intra);
  EXPECT_EQ(peek(*packets[1].packet)->blocks, 12U);
  for (const OutgoingPacket& packet : packets) {
    ASSERT_EQ(decoder->decode(*packet.packet), Status::ok);
  }
  EXPECT_EQ(contents(*decoder), texture.blocks());
  EXPECT_EQ(*distributor->state_hash(*client, {0, 0}), decoder->state_hash());
}

TEST(Scroll, WhatStoodThereIsSentAgainEvenIfItIsTheSame) {
  const VolumeGeometry volume{{3, 1, 1}};
  const TextureDesc desc = ddgi_irradiance(volume.grid);
  auto distributor = Distributor::create();
  ASSERT_TRUE(distributor.ok());
  ASSERT_TRUE(distributor->add_volume(probes_of({{"color", desc}}), volume).ok());
  const auto client = distributor->connect();
  ASSERT_TRUE(client.ok());
  ASSERT_EQ(distributor->set_visible(*client, 0, BlockMask{1, 1, 0}), Status::ok);
  Texture texture(desc);  // All black, so that nothing is sent at first.
  ASSERT_EQ(distributor->publish(0, 0, std::as_const(texture).view()), Status::ok);
  ASSERT_EQ(distributor->update(), Status::ok);
  ASSERT_EQ(distributor->scroll(0, {3, 0, 0}), Status::ok);
  ASSERT_EQ(distributor->update(), Status::ok);
  EXPECT_TRUE(distributor->packets(*client).empty());  // Nobody has said what is there.
  ASSERT_EQ(distributor->publish(0, 0, std::as_const(texture).view(), {}), Status::ok);
  ASSERT_EQ(distributor->update(), Status::ok);
  ASSERT_EQ(distributor->packets(*client).size(), 1U);
  EXPECT_EQ(distributor->packets(*client)[0].blocks, 2U);
  ASSERT_EQ(distributor->update(), Status::ok);
  EXPECT_TRUE(distributor->packets(*client).empty());
  EXPECT_EQ(distributor->scroll(0, {kMaxScroll + 1, 0, 0}), Status::invalid_geometry);
}

}  // namespace
}  // namespace gicodec
