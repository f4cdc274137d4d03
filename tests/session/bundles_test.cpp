// Groups of textures: those that travel together, presence, names, ranks.
#include "session/bricks.h"

#include <gicodec/textures.h>

#include <set>

namespace gicodec {
namespace {

using namespace test;

/// A volume of two textures of six records that travel together.
VolumeDesc together(Grid grid) {
  TextureGroup group;
  group.bundled = true;
  group.textures = {texture("direction", Format::R8G8B8_SNORM, 6, grid),
                    texture("color", Format::E5B9G9R9_UFLOAT_PACK32, 6, grid)};
  return *texture_volume(std::span(&group, 1));
}

class TogetherOver : public testing::TestWithParam<Delivery> {};

TEST_P(TogetherOver, ABlockComesInAllTexturesOrInNone) {
  constexpr Grid kGrid{4, 3, 2};
  constexpr std::uint32_t kBlocks = 24, kBudget = 6;
  const VolumeDesc volume = together(kGrid);
  Distributor distributor = make_distributor("zstd");
  ASSERT_TRUE(distributor.add_volume(volume, {kGrid}).ok());
  const ClientId client = *distributor.connect(GetParam(), {kBudget, 0});
  ASSERT_EQ(distributor.set_visible(client, 0, BlockMask(kBlocks, 1)), Status::ok);
  Random random(4);
  Texture direction(volume.groups[0].textures[0].desc), color(volume.groups[0].textures[1].desc);
  direction.fill(Fill::noise, random);
  color.fill(Fill::noise, random);
  ASSERT_EQ(distributor.publish(0, 0, std::as_const(direction).view()), Status::ok);
  ASSERT_EQ(distributor.update(), Status::ok);
  EXPECT_TRUE(distributor.packets(client).empty()) << "one of them was not published yet";
  ASSERT_EQ(distributor.publish(0, 1, std::as_const(color).view()), Status::ok);
  std::map<StreamId, Decoder> decoders;
  std::uint32_t updates_with_some = 0;
  for (int update = 0; update < 40; ++update) {
    if (update % 2 == 0) {  // Only one of them changes.
      color.fill_block(static_cast<std::uint32_t>(update) % kBlocks, Fill::noise, random);
      ASSERT_EQ(distributor.publish(0, 1, std::as_const(color).view()), Status::ok);
    }
    ASSERT_EQ(distributor.update(), Status::ok);
    auto sent = sent_by(distributor, client, decoders, volume);
    EXPECT_EQ(sent[0], sent[1]);
    if (GetParam() == Delivery::unicast) {
      EXPECT_LE(sent[0].size() + sent[1].size(), kBudget);
    }
    updates_with_some += sent[0].empty() ? 0 : 1;
  }
  EXPECT_GT(updates_with_some, 10U);
  for (auto& [stream, decoder] : decoders) {
    EXPECT_EQ(*distributor.state_hash(client, stream), decoder.state_hash());
  }
}

INSTANTIATE_TEST_SUITE_P(Deliveries, TogetherOver,
                         testing::Values(Delivery::unicast, Delivery::shared));

TEST(Lots, WhatTravelsTogetherOrNamesHasOneInterval) {
  const VolumeDesc volume = together({2, 2, 2});
  const StreamedTexture uneven[] = {{"direction", 1}, {"color", 2}},
                        even[] = {{"direction", 2}, {"color", 2}};
  Distributor distributor = make_distributor();
  EXPECT_EQ(distributor.add_volume(volume, {{2, 2, 2}}, uneven).status(), Status::invalid_interval);
  EXPECT_TRUE(distributor.add_volume(volume, {{2, 2, 2}}, even).ok());
}

/// A block that is black is received all the same, once.
TEST(Lots, BlackBlocksAreSentOnce) {
  constexpr Grid kGrid{3, 2, 1};
  const VolumeDesc volume = probes_of({{"color", ddgi_irradiance(kGrid)}});
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    Distributor distributor = make_distributor();
    ASSERT_TRUE(distributor.add_volume(volume, {kGrid}).ok());
    const ClientId client = *distributor.connect(delivery);
    ASSERT_EQ(distributor.set_visible(client, 0, BlockMask(6, 1)), Status::ok);
    const Texture black(ddgi_irradiance(kGrid));
    ASSERT_EQ(distributor.publish(0, 0, black.view()), Status::ok);
    ASSERT_EQ(distributor.update(), Status::ok);
    std::map<StreamId, Decoder> decoders;
    EXPECT_EQ(sent_by(distributor, client, decoders, volume)[0].size(), 6U);
    for (const std::uint8_t received : decoders.begin()->second.received()) EXPECT_EQ(received, 1);
    ASSERT_EQ(distributor.publish(0, 0, black.view()), Status::ok);
    ASSERT_EQ(distributor.update(), Status::ok);
    EXPECT_TRUE(distributor.packets(client).empty());
    EXPECT_EQ(distributor.state(client)->pending, 0U);
  }
}

TEST(Lots, WhatExistsIsPublishedFirst) {
  World world(4, {2, 2, 1});
  Distributor distributor = make_distributor();
  ASSERT_TRUE(distributor.add_volume(world.volume, {{4, 1, 1}}).ok());
  world.publish(distributor);
  ASSERT_EQ(distributor.update(), Status::ok);
  world.set_lights(1, 3);
  ASSERT_EQ(distributor.publish(0, 0, std::as_const(world.exists).view()), Status::ok);
  EXPECT_EQ(distributor.update(), Status::presence_missing) << "the lights are those of before";
  ASSERT_EQ(distributor.publish(0, 1, std::as_const(world.lights).view()), Status::ok);
  EXPECT_EQ(distributor.update(), Status::ok);
  world.set_lights(2, 5);
  ASSERT_EQ(distributor.publish(0, 0, std::as_const(world.exists).view()), Status::ok);
  EXPECT_EQ(distributor.publish(0, 1, std::as_const(world.lights).view()), Status::presence_invalid)
      << "a brick has four";
}

/// Counts and masks over the wire: what does not exist is zero at the client, whatever is
/// published.
TEST(Lots, PresenceGoesOverTheWire) {
  for (const Presence presence : {Presence::count, Presence::mask}) {
    World world(6, {1, 1, 1}, presence);
    for (std::uint32_t brick = 0; brick < 6; ++brick) {
      world.set_lights(
          brick, static_cast<std::uint8_t>(presence == Presence::mask ? 2 * brick : brick % 5));
    }
    for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
      Distributor distributor = make_distributor("zstd");
      ASSERT_TRUE(distributor.add_volume(world.volume, {{6, 1, 1}}).ok());
      const ClientId client = *distributor.connect(delivery);
      ASSERT_EQ(distributor.set_visible(client, 0, BlockMask(6, 1)), Status::ok);
      world.publish(distributor);
      ASSERT_EQ(distributor.update(), Status::ok);
      const auto packets = distributor.packets(client);
      ASSERT_EQ(packets.size(), 2U);
      ASSERT_EQ(packets[0].stream.texture, 0);
      auto existing = *Decoder::create(world.exists.desc());
      auto lights = *Decoder::create(world.lights.desc());
      ASSERT_EQ(existing.decode(*packets[0].packet), Status::ok);
      ASSERT_EQ(lights.set_presence(existing.records()), Status::ok);
      ASSERT_EQ(lights.decode(*packets[1].packet), Status::ok);
      for (std::uint32_t brick = 0; brick < 6; ++brick) {
        Bytes expected = world.lights.block(brick);
        clear_absent_records(world.lights.desc(), world.exists.block(brick), expected);
        EXPECT_EQ(block_of(world.lights.desc(), contents(lights), brick), expected);
      }
    }
  }
}

TEST(Lots, HigherRanksComeFirst) {
  World world(8, {1, 1, 1});
  for (std::uint32_t brick = 0; brick < 8; ++brick) {
    world.set_lights(brick, static_cast<std::uint8_t>(brick % 4));
  }
  Distributor distributor = make_distributor();
  ASSERT_TRUE(distributor.add_volume(world.volume, {{8, 1, 1}}).ok());
  const ClientId client =
      *distributor.connect(Delivery::unicast, {4, 0});  // Two bricks of two textures.
  ASSERT_EQ(distributor.set_visible(client, 0, BlockMask(8, 1)), Status::ok);
  world.publish(distributor);
  std::map<StreamId, Decoder> decoders;
  std::vector<std::vector<std::uint32_t>> order;
  for (int update = 0; update < 4; ++update) {
    ASSERT_EQ(distributor.update(), Status::ok);
    std::vector<std::uint32_t> sent;
    for (const OutgoingPacket& packet : distributor.packets(client)) {
      if (packet.stream.texture != 0) continue;
      auto it = decoders.try_emplace(packet.stream, *Decoder::create(world.exists.desc())).first;
      ASSERT_EQ(it->second.decode(*packet.packet), Status::ok);
      sent = listed_blocks(it->second, *packet.packet);
    }
    order.push_back(sent);
  }
  EXPECT_EQ(order, (std::vector<std::vector<std::uint32_t>>{{3, 7}, {2, 6}, {1, 5}, {0, 4}}));
}

/// Nothing that is named comes later than what names it, however little there is room for and
/// whatever is lost, and everything comes in the end.
TEST(Lots, NamedBlocksComeFirst) {
  constexpr std::uint32_t kPool = 8, kCells = 6;
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    for (const std::uint32_t budget : {0U, 1U, 5U}) {
      World world(kPool, {3, 2, 1});
      ClientOptions options;
      options.delivery = delivery;
      options.budget.blocks = budget;
      Pair pair(world, options);
      // It sees cells only; what they name it wants, too.
      pair.look(1, BlockMask(kCells, 1));
      std::uint32_t named = 0;
      for (std::uint32_t update = 0; update < 400; ++update) {
        if (update < 60 && update % 3 == 0) {
          const std::uint32_t brick = update * 5 % kPool;
          world.set_lights(brick, static_cast<std::uint8_t>(1 + update % 4));
          world.name(update % kCells, brick);
          world.publish(pair.server());
        }
        pair.update(update % 7 == 4);
        const ClientFrame& frame = pair.client().frame();
        if (frame.serial == 0 || !pair.client().consistent()) continue;
        for (std::uint32_t cell = 0; cell < kCells; ++cell) {
          const ClientVolume& volume = pair.volume();
          if (volume.textures[2].changed[cell] != frame.serial) continue;
          std::uint32_t brick = 0;
          if (brick_of(pair.held(2, cell), std::span(&brick, 1)) == 0) continue;
          ++named;
          for (std::size_t id : {0, 1}) EXPECT_NE(volume.textures[id].changed[brick], 0U);
          EXPECT_EQ(pair.held(0, brick), world.exists.block(brick));
        }
      }
      EXPECT_GE(named, kCells / 2);
      for (std::uint32_t cell = 0; cell < kCells; ++cell) {
        EXPECT_EQ(pair.held(2, cell), world.cells.block(cell));
      }
      EXPECT_EQ(pair.server().statistics(pair.connection())->pending, 0U);
    }
  }
}

/// What a block names that is not sent at all is not waited for.
TEST(Lots, InactiveBlocksAreNotWaitedFor) {
  World world(4, {1, 1, 1});
  world.name(0, 2);
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    ClientOptions options;
    options.delivery = delivery;
    Pair pair(world, options);
    ASSERT_EQ(pair.server().set_active(0, BlockMask{1, 1, 0, 1}), Status::ok);
    pair.look(1, BlockMask(1, 1));
    world.publish(pair.server());
    pair.update();
    EXPECT_NE(pair.volume().textures[2].changed[0], 0U);
    EXPECT_EQ(pair.volume().textures[0].changed[2], 0U);
  }
}

/// A block waits for the regions that hold what it names, not for all that it might name.
TEST(Lots, OnlyRegionsThatHoldWhatIsNamedAreWaitedFor) {
  World world(8, {1, 1, 1});
  for (std::uint32_t brick = 0; brick < 8; ++brick) world.set_lights(brick, 4);
  world.name(0, 5);
  DistributorOptions options;
  options.backend = "raw";
  options.region = {1, 1, 1};
  auto distributor = *Distributor::create(options);
  ASSERT_TRUE(distributor.add_volume(world.volume, {{8, 1, 1}}).ok());
  const ClientId client = *distributor.connect(Delivery::shared);
  ASSERT_EQ(distributor.set_visible(client, 0, BlockMask(1, 1), 1), Status::ok);
  distributor.set_limit_for_few(1);  // One region in an update.
  world.publish(distributor);
  std::set<std::uint32_t> bricks_there;
  bool cell_there = false;
  for (int update = 0; update < 100 && !cell_there; ++update) {
    ASSERT_EQ(distributor.update(), Status::ok);
    for (const OutgoingPacket& packet : distributor.packets(client)) {
      if (packet.stream.texture == 2) {
        cell_there = true;
      } else {
        bricks_there.insert(packet.stream.region);
      }
    }
  }
  EXPECT_TRUE(cell_there);
  EXPECT_TRUE(bricks_there.contains(5));
  EXPECT_LT(bricks_there.size(), 8U);
}

}  // namespace
}  // namespace gicodec
