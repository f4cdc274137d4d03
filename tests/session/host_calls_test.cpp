// What a Host and a Client are asked out of order, with a wrong number or too much of it; what they
// do where they were told nothing.
#include "../messages.h"
#include "session/bricks.h"
#include "session/host_fixture.h"

#include <cmath>
#include <limits>
#include <numeric>

namespace gicodec {
namespace {

using namespace test;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST_F(HostTest, MisuseIsNamed) {
  make();
  const auto view = std::as_const(texture_).view();
  const BlockMask mask(kBlocks, 1), longer(kBlocks + 1, 1);
  EXPECT_EQ(host_->publish(1, 0, view), Status::unknown_volume);
  EXPECT_EQ(host_->publish(0, 1, view), Status::unknown_texture);
  EXPECT_EQ(host_->publish(0, 0, ConstTextureView(view.bytes.first(100))), Status::view_too_small);
  const std::uint32_t beyond[] = {3, kBlocks}, twice[] = {5, 2, 5};
  EXPECT_EQ(host_->publish(0, 0, view, beyond), Status::block_out_of_range);
  EXPECT_EQ(host_->publish(0, 0, view, twice), Status::block_repeated);
  EXPECT_EQ(host_->scroll(1, {1, 0, 0}), Status::unknown_volume);
  EXPECT_EQ(host_->scroll(0, {kMaxScroll + 1, 0, 0}), Status::invalid_geometry);
  EXPECT_EQ(host_->geometry(1).status(), Status::unknown_volume);
  EXPECT_EQ(host_->set_active(1, mask), Status::unknown_volume);
  EXPECT_EQ(host_->set_active(0, mask, 1), Status::unknown_set);
  EXPECT_EQ(host_->set_active(0, longer), Status::mask_mismatch);
  EXPECT_EQ(host_->connect(std::nan("")).status(), Status::invalid_time);
  EXPECT_EQ(host_->update(kInfinity, 0), Status::invalid_time);
  EXPECT_EQ(host_->update(0, std::nan("")), Status::invalid_time);
  EXPECT_EQ(host_->updates(), 0U);

  Client client = make_client();
  EXPECT_EQ(host_->set_visible(1, 0, mask), Status::unknown_peer);
  const PeerId silent = connect();  // It has no session yet.
  EXPECT_EQ(host_->set_visible(silent, 0, mask), Status::unknown_peer);
  const PeerId peer = join(client);
  EXPECT_EQ(host_->set_visible(peer, 1, mask), Status::unknown_volume);
  EXPECT_EQ(host_->set_visible(peer, 0, mask, 1), Status::unknown_set);
  EXPECT_EQ(host_->set_visible(peer, 0, longer), Status::mask_mismatch);
  EXPECT_EQ(host_->set_visible(peer, 0, {}), Status::ok);
  EXPECT_EQ(host_->remove_volume(1), Status::unknown_volume);
  host_->drop(peer, Reason::left);
  EXPECT_EQ(host_->set_visible(peer, 0, mask), Status::unknown_peer);
  EXPECT_TRUE(host_->packets(peer).empty());
  EXPECT_FALSE(host_->statistics(peer + 1).has_value());
}

TEST_F(HostTest, VolumesThatCannotBeAreNamed) {
  const VolumeDesc volume = probes_of({{"color", ddgi_irradiance(kGrid)}});
  const auto add = [&](std::vector<StreamedTexture> textures, VolumeGeometry geometry = {kGrid}) {
    auto host = Host::create();
    const Status status = host->add_volume("volume", volume, geometry, textures).status();
    EXPECT_EQ(host->volumes(), status == Status::ok ? 1U : 0U);
    return status;
  };
  EXPECT_EQ(add({}), Status::ok);
  EXPECT_EQ(add({{.texture = "color"}}), Status::ok);
  EXPECT_EQ(add({{.texture = "colour"}}), Status::unknown_texture);
  EXPECT_EQ(add({{}}), Status::unknown_texture);
  EXPECT_EQ(add({{.texture = "color"}, {.texture = "color"}}), Status::invalid_name);
  EXPECT_EQ(add({{.texture = "color", .interval = 0}}), Status::invalid_interval);
  EXPECT_EQ(add({{.texture = "color", .threshold = -1}}), Status::invalid_bound);
  EXPECT_EQ(add({{.texture = "color", .threshold = 1, .max_error = 1}}), Status::invalid_bound);
  EXPECT_EQ(add({}, {{4, 2, 2}}), Status::invalid_geometry);
  EXPECT_EQ(add({}, {kGrid, {0, 0, 0}, {1, 0, 1}}), Status::invalid_geometry);
  EXPECT_EQ(add({}, {kGrid, {kInfinity, 0, 0}}), Status::invalid_geometry);
  EXPECT_EQ(Host::create({.backend = "none"}).status(), Status::unknown_backend);
  EXPECT_EQ(Host::create({.threads = 0}).status(), Status::invalid_settings);
  EXPECT_EQ(Host::create({.region = {0, 1, 1}}).status(), Status::invalid_argument);
}

TEST_F(HostTest, StreamedTexturesAreNamed) {
  auto host = *Host::create({.backend = "raw", .proofs = true});
  const Texture color(ddgi_irradiance(kGrid));
  Texture distance(ddgi_visibility(kGrid));
  const VolumeDesc volume = probes_of({{"color", color.desc()}, {"vis", distance.desc()}});
  const StreamedTexture rates[] = {{.texture = "vis", .interval = 2, .source_error = 3}};
  ASSERT_TRUE(host.add_volume("volume", volume, {kGrid}, rates).ok());
  Client client = make_client();
  const PeerId peer = *host.connect(0);
  host.receive(peer, *client.hello(), 0);
  for (int update = 1; update <= 4; ++update) {
    distance.fill(Fill::noise, random_);
    ASSERT_EQ(host.publish(0, 0, color.view()), Status::ok);
    ASSERT_EQ(host.publish(0, 1, std::as_const(distance).view()), Status::ok);
    ASSERT_EQ(host.update(update, update), Status::ok);
    bool sent = false;
    for (const OutgoingPacket& packet : host.packets(peer)) sent |= packet.stream.texture == 1;
    EXPECT_EQ(sent, update % 2 == 0);
    for (const Message& message : joined(host.take_messages(peer))) {
      ASSERT_EQ(client.receive(message), Status::ok);
    }
    for (const Message& reply : client.take_messages()) host.receive(peer, reply, update);
  }
  EXPECT_EQ(client.frame().volumes[0].textures[0].largest_error, 0);
  EXPECT_EQ(client.frame().volumes[0].textures[1].largest_error, 3);
}

TEST_F(HostTest, EverythingIsSeenUntilToldOtherwise) {
  for (const Delivery delivery : {Delivery::own, Delivery::shared}) {
    make();
    Client client = make_client({.delivery = delivery});
    const PeerId peer = connect();
    host_->receive(peer, *client.hello(), now_);
    update();
    exchange(peer, client);
    const ClientTexture& held = client.frame().volumes[0].textures[0];
    EXPECT_TRUE(std::ranges::equal(held.texels, std::as_const(texture_).view().bytes));
    ASSERT_EQ(host_->set_visible(peer, 0, {}), Status::ok);
    update();
    EXPECT_TRUE(host_->packets(peer).empty());
  }
}

/// Blocks that are not listed stay as they were, but for those that must be read.
TEST_F(HostTest, PublishesWhatIsListed) {
  for (const Delivery delivery : {Delivery::own, Delivery::shared}) {
    make();
    Client client = make_client({.delivery = delivery});
    const PeerId peer = connect();
    host_->receive(peer, *client.hello(), now_);
    const auto held = [&](std::uint32_t block) {
      return block_of(texture_.desc(), client.frame().volumes[0].textures[0].texels, block);
    };
    const auto publish = [&](std::vector<std::uint32_t> blocks) {
      now_ += 0.1;
      texture_.fill(Fill::noise, random_);
      ASSERT_EQ(host_->publish(0, 0, std::as_const(texture_).view(), blocks), Status::ok);
      ASSERT_EQ(host_->update(now_, now_), Status::ok);
      exchange(peer, client);
    };
    publish({7});  // The first time all are read.
    for (std::uint32_t block = 0; block < kBlocks; ++block) {
      EXPECT_EQ(held(block), texture_.block(block));
    }
    const Bytes before = held(5);
    publish({9, 2});
    EXPECT_EQ(held(2), texture_.block(2));
    EXPECT_EQ(held(9), texture_.block(9));
    EXPECT_EQ(held(5), before);
    const auto entering = entering_blocks(kGrid, {0, 0, 0}, {1, 0, 0});
    ASSERT_EQ(host_->scroll(0, {1, 0, 0}), Status::ok);
    publish({});
    for (std::uint32_t block = 0; block < kBlocks; ++block) {
      const bool entered = std::ranges::count(entering, block) > 0;
      EXPECT_EQ(held(block) == texture_.block(block), entered) << block;
    }
    EXPECT_EQ(client.statistics().failed_proofs, 0U);
  }
}

/// What exists decides what is read of the rest.
TEST(HostCalls, RecordsAreReadWherePresenceChanged) {
  World world(4, {2, 1, 1});
  for (std::uint32_t brick = 0; brick < 4; ++brick) world.set_lights(brick, 2);
  Pair pair(world);
  pair.look(0, BlockMask(4, 1));
  world.publish(pair.host());
  pair.update();
  world.set_lights(1, 4);
  const std::uint32_t changed[] = {1};
  const std::uint32_t* const none = nullptr;
  ASSERT_EQ(pair.host().publish(0, 0, std::as_const(world.exists).view(), changed), Status::ok);
  EXPECT_EQ(pair.host().update(1, 1), Status::presence_missing);
  ASSERT_EQ(pair.host().publish(0, 1, std::as_const(world.lights).view(), {none, 0}), Status::ok);
  pair.update();
  EXPECT_EQ(pair.held(0, 1), world.exists.block(1));
  EXPECT_EQ(pair.held(1, 1), world.lights.block(1));
  // A count beyond the block's four.
  Bytes many(world.exists.block(2).size());
  many[0] = std::byte{5};
  world.exists.set_block(2, many);
  ASSERT_EQ(pair.host().publish(0, 0, std::as_const(world.exists).view()), Status::ok);
  EXPECT_EQ(pair.host().publish(0, 1, std::as_const(world.lights).view()),
            Status::presence_invalid);
}

/// Into pitched memory of the caller's, straight from what was decoded; frames have no texels then.
TEST_F(HostTest, BlocksAreReadToWhereTheyAreNeeded) {
  for (const Delivery delivery : {Delivery::own, Delivery::shared}) {
    for (const bool texels : {false, true}) {
      make({.region = {2, 2, 2}});
      Client client = make_client({.delivery = delivery, .texels = texels});
      const PeerId peer = connect();
      host_->receive(peer, *client.hello(), now_);
      Texture mapped(texture_.desc(), 256, 64);
      std::uint64_t serial = 0;
      for (int i = 0; i < 5; ++i) {
        now_ += 0.1;
        for (const std::uint32_t block : random_selection(random_, kBlocks)) {
          texture_.fill_block(block, Fill::noise, random_);
          if (i % 2 == 0) texture_.fill_band(block);
        }
        ASSERT_EQ(host_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
        ASSERT_EQ(host_->update(now_, now_), Status::ok);
        exchange(peer, client);
        if (i == 2) continue;  // A renderer that is slower.
        ASSERT_EQ(client.read(0, 0, serial, mapped.view()), Status::ok);
        serial = client.frame().serial;
        EXPECT_EQ(mapped.blocks(), texture_.blocks());
        EXPECT_TRUE(mapped.padding_untouched());
        EXPECT_EQ(client.frame().volumes[0].textures[0].texels.empty(), !texels);
      }
      EXPECT_EQ(client.read(1, 0, 0, mapped.view()), Status::unknown_volume);
      EXPECT_EQ(client.read(0, 1, 0, mapped.view()), Status::unknown_texture);
      EXPECT_EQ(client.read(0, 0, 0, TextureView{mapped.view().bytes.first(99)}),
                Status::view_too_small);
    }
  }
}

TEST_F(HostTest, WishesAreKept) {
  make();
  Client client = make_client();
  BlockMask some(kBlocks);
  some[3] = 1;
  const Viewpoint view{{1, 2, 3}};
  // Before there is a connection.
  ASSERT_EQ(client.look(view), Status::ok);
  ASSERT_EQ(client.subscribe(0, some), Status::ok);
  ASSERT_EQ(client.subscribe(7, some), Status::ok);
  EXPECT_TRUE(client.take_messages().empty());
  for (int session = 0; session < 2; ++session) {
    const PeerId peer = connect();
    host_->receive(peer, *client.hello(), now_);
    exchange(peer, client);
    EXPECT_FALSE(client.resumed());
    ASSERT_TRUE(host_->viewpoint(peer).has_value());
    EXPECT_EQ(host_->viewpoint(peer)->eye, view.eye);
    update();
    ASSERT_EQ(host_->packets(peer).size(), 1U);
    EXPECT_EQ(host_->packets(peer)[0].blocks, 1U);
    exchange(peer, client);
    EXPECT_EQ(client.subscribe(7, some), Status::unknown_volume);
    EXPECT_EQ(client.subscribe(0, some, 1), Status::unknown_set);
    EXPECT_EQ(client.subscribe(0, BlockMask(2, 1)), Status::mask_mismatch);
    ASSERT_EQ(client.leave(), Status::ok);
    const auto messages = client.take_messages();
    ASSERT_EQ(messages.size(), 1U);
    host_->receive(peer, messages[0], now_);
    EXPECT_EQ(dropped(peer), Reason::left);
    EXPECT_EQ(client.receive(messages[0]), Status::end);
  }
}

/// One packet takes the region's streams to where who is behind lacks blocks of both kinds.
TEST_F(HostTest, WhoIsBehindCatchesUpInAScrollingVolume) {
  make({.region = {8, 8, 8}, .max_in_flight = 1});
  struct Peer {
    Client client;
    PeerId id = 0;
    std::vector<Message> replies = {};
  };
  Peer early{make_client({.delivery = Delivery::shared})};
  Peer late{make_client({.delivery = Delivery::shared})};
  for (Peer* peer : {&early, &late}) peer->id = join(peer->client);
  const auto receive = [&] {
    for (Peer* peer : {&early, &late}) {
      for (const Message& message : joined(host_->take_messages(peer->id))) {
        ASSERT_EQ(peer->client.receive(message), Status::ok);
      }
      for (Message& reply : peer->client.take_messages()) {
        peer->replies.push_back(std::move(reply));
      }
    }
  };
  const auto answer = [&](Peer& peer) {
    for (const Message& reply : peer.replies) host_->receive(peer.id, reply, now_);
    peer.replies.clear();
  };
  const auto change = [&](std::vector<std::uint32_t> blocks, std::int32_t scroll) {
    now_ += 0.01;
    for (const std::uint32_t block : blocks) texture_.fill_block(block, Fill::noise, random_);
    ASSERT_EQ(host_->scroll(0, {scroll, 0, 0}), Status::ok);
    ASSERT_EQ(host_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
    ASSERT_EQ(host_->update(now_, now_), Status::ok);
    receive();
  };
  receive();
  answer(early);
  answer(late);
  std::vector<std::uint32_t> all(kBlocks);
  std::iota(all.begin(), all.end(), 0U);
  change(all, 0);
  answer(early);
  change({0, 1}, 1);
  answer(late);
  change(all, 2);
  answer(late);
  answer(early);
  for (int i = 0; i < 4; ++i) {
    change({}, 2);
    answer(early);
    answer(late);
  }
  for (const Peer* peer : {&early, &late}) {
    EXPECT_TRUE(peer->client.consistent());
    EXPECT_EQ(peer->client.statistics().failed_proofs, 0U);
    EXPECT_TRUE(std::ranges::equal(peer->client.frame().volumes[0].textures[0].texels,
                                   std::as_const(texture_).view().bytes));
  }
}

/// What stands where a block entered is not known until the renderer says so.
TEST_F(HostTest, BlocksThatEnteredWaitUntilTheyArePublished) {
  for (const Delivery delivery : {Delivery::own, Delivery::shared}) {
    make();
    Client client = make_client({.delivery = delivery});
    const PeerId peer = join(client);
    const auto next = [&] {
      now_ += 0.1;
      ASSERT_EQ(host_->update(now_, now_), Status::ok);
      exchange(peer, client);
    };
    texture_.fill(Fill::noise, random_);
    ASSERT_EQ(host_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
    for (int i = 0; i < 8; ++i) next();
    EXPECT_EQ(host_->statistics(peer)->owed, 0U);
    ASSERT_EQ(host_->scroll(0, {1, 0, 0}), Status::ok);
    next();
    next();
    const auto& changed = client.frame().volumes[0].textures[0].changed;
    const auto entered = entering_blocks(kGrid, {0, 0, 0}, {1, 0, 0});
    for (const std::uint32_t block : entered) EXPECT_EQ(changed[block], 0U);
    EXPECT_EQ(std::ranges::count(changed, 0U), static_cast<std::ptrdiff_t>(entered.size()));
    ASSERT_EQ(host_->publish(0, 0, std::as_const(texture_).view(), {}), Status::ok);
    for (int i = 0; i < 4; ++i) next();
    EXPECT_EQ(std::ranges::count(changed, 0U), 0);
    EXPECT_TRUE(std::ranges::equal(client.frame().volumes[0].textures[0].texels,
                                   std::as_const(texture_).view().bytes));
  }
}

TEST_F(HostTest, ViewpointsThatAreNoneAreRefusedAtOnce) {
  make();
  Client client = make_client();
  Viewpoint none;
  none.eye = {std::nanf(""), 0, 0};
  EXPECT_EQ(client.look(none), Status::invalid_argument);
  none = {};
  none.fov_y = 200;
  EXPECT_EQ(client.look(none), Status::invalid_argument);
  const PeerId peer = join(client);
  exchange(peer, client);
  EXPECT_TRUE(client.welcome());
}

/// Renderers know their textures by the instance, whichever server a volume is of.
TEST_F(HostTest, InstancesAreGivenOnce) {
  Client client = make_client();
  std::vector<std::uint64_t> seen;
  for (int servers = 0; servers < 2; ++servers) {
    make();
    const PeerId peer = join(client);
    exchange(peer, client);
    for (int i = 0; i < 2; ++i) {
      update();
      exchange(peer, client);
      ASSERT_EQ(client.frame().volumes.size(), 1U);
      EXPECT_EQ(std::ranges::count(seen, client.frame().volumes[0].instance), i);
      if (i == 0) seen.push_back(client.frame().volumes[0].instance);
    }
  }
  EXPECT_EQ(seen.size(), 2U);
}

}  // namespace
}  // namespace gicodec
