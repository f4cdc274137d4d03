// What a Server and a Client are asked out of order, with a wrong number or too much of it; what
// they do where they were told nothing.
#include "../messages.h"
#include "session/bricks.h"
#include "session/server_fixture.h"

#include <cmath>
#include <limits>
#include <numeric>

namespace gicodec {
namespace {

using namespace test;

constexpr float kInfinite = std::numeric_limits<float>::infinity();

TEST_F(ServerTest, MisuseIsNamed) {
  make();
  const auto view = std::as_const(texture_).view();
  const BlockMask mask(kBlocks, 1), longer(kBlocks + 1, 1);
  EXPECT_EQ(server_->publish(1, 0, view), Status::unknown_volume);
  EXPECT_EQ(server_->publish(0, 1, view), Status::unknown_texture);
  EXPECT_EQ(server_->publish(0, 0, ConstTextureView(view.bytes.first(100))),
            Status::view_too_small);
  const std::uint32_t beyond[] = {3, kBlocks}, twice[] = {5, 2, 5};
  EXPECT_EQ(server_->publish(0, 0, view, beyond), Status::block_out_of_range);
  EXPECT_EQ(server_->publish(0, 0, view, twice), Status::block_repeated);
  EXPECT_EQ(server_->scroll(1, {1, 0, 0}), Status::unknown_volume);
  EXPECT_EQ(server_->scroll(0, {kMaxScroll + 1, 0, 0}), Status::invalid_geometry);
  EXPECT_EQ(server_->geometry(1).status(), Status::unknown_volume);
  EXPECT_EQ(server_->set_active(1, mask), Status::unknown_volume);
  EXPECT_EQ(server_->set_active(0, mask, 1), Status::unknown_group);
  EXPECT_EQ(server_->set_active(0, longer), Status::mask_mismatch);
  EXPECT_EQ(server_->connect(std::nan("")).status(), Status::invalid_time);
  EXPECT_EQ(server_->update(kInfinite, 0), Status::invalid_time);
  EXPECT_EQ(server_->update(0, std::nan("")), Status::invalid_time);
  EXPECT_EQ(server_->updates(), 0U);

  Client client = make_client();
  EXPECT_EQ(server_->set_visible(1, 0, mask), Status::unknown_connection);
  const ConnectionId silent = connect();  // It has no session yet.
  EXPECT_EQ(server_->set_visible(silent, 0, mask), Status::unknown_connection);
  const ConnectionId connection = join(client);
  EXPECT_EQ(server_->set_visible(connection, 1, mask), Status::unknown_volume);
  EXPECT_EQ(server_->set_visible(connection, 0, mask, 1), Status::unknown_group);
  EXPECT_EQ(server_->set_visible(connection, 0, longer), Status::mask_mismatch);
  EXPECT_EQ(server_->set_visible(connection, 0, {}), Status::ok);
  EXPECT_EQ(server_->remove_volume(1), Status::unknown_volume);
  server_->drop(connection, Reason::left);
  EXPECT_EQ(server_->set_visible(connection, 0, mask), Status::unknown_connection);
  EXPECT_TRUE(server_->packets(connection).empty());
  EXPECT_FALSE(server_->statistics(connection + 1).has_value());
}

TEST_F(ServerTest, VolumesThatCannotBeAreNamed) {
  const VolumeDesc volume = probes_of({{"color", ddgi_irradiance(kGrid)}});
  const auto add = [&](std::vector<StreamedTexture> textures, VolumeGeometry geometry = {kGrid}) {
    auto server = Server::create();
    const Status status = server->add_volume("volume", volume, geometry, textures).status();
    EXPECT_EQ(server->volumes(), status == Status::ok ? 1U : 0U);
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
  EXPECT_EQ(add({}, {kGrid, {kInfinite, 0, 0}}), Status::invalid_geometry);
  EXPECT_EQ(Server::create({.backend = "none"}).status(), Status::unknown_backend);
  EXPECT_EQ(Server::create({.threads = 0}).status(), Status::invalid_settings);
  EXPECT_EQ(Server::create({.region = {0, 1, 1}}).status(), Status::invalid_argument);
}

TEST_F(ServerTest, StreamedTexturesAreNamed) {
  auto server = *Server::create({.backend = "raw", .proofs = true});
  const Texture color(ddgi_irradiance(kGrid));
  Texture distance(ddgi_visibility(kGrid));
  const VolumeDesc volume = probes_of({{"color", color.desc()}, {"vis", distance.desc()}});
  const StreamedTexture rates[] = {{.texture = "vis", .interval = 2, .source_error = 3}};
  ASSERT_TRUE(server.add_volume("volume", volume, {kGrid}, rates).ok());
  Client client = make_client();
  const ConnectionId connection = *server.connect(0);
  server.receive(connection, *client.hello(), 0);
  for (int update = 1; update <= 4; ++update) {
    distance.fill(Fill::noise, random_);
    ASSERT_EQ(server.publish(0, 0, color.view()), Status::ok);
    ASSERT_EQ(server.publish(0, 1, std::as_const(distance).view()), Status::ok);
    ASSERT_EQ(server.update(update, update), Status::ok);
    bool sent = false;
    for (const OutgoingPacket& packet : server.packets(connection))
      sent |= packet.stream.texture == 1;
    EXPECT_EQ(sent, update % 2 == 0);
    for (const Message& message : joined(server.take_messages(connection))) {
      ASSERT_EQ(client.receive(message), Status::ok);
    }
    for (const Message& reply : client.take_messages()) server.receive(connection, reply, update);
  }
  EXPECT_EQ(client.frame().volumes[0].textures[0].largest_error, 0);
  EXPECT_EQ(client.frame().volumes[0].textures[1].largest_error, 3);
}

TEST_F(ServerTest, EverythingIsSeenUntilToldOtherwise) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    make();
    Client client = make_client({.delivery = delivery});
    const ConnectionId connection = connect();
    server_->receive(connection, *client.hello(), now_);
    update();
    exchange(connection, client);
    const ClientTexture& held = client.frame().volumes[0].textures[0];
    EXPECT_TRUE(std::ranges::equal(held.texels, std::as_const(texture_).view().bytes));
    ASSERT_EQ(server_->set_visible(connection, 0, {}), Status::ok);
    update();
    EXPECT_TRUE(server_->packets(connection).empty());
  }
}

/// Blocks that are not listed stay as they were, but for those that must be read.
TEST_F(ServerTest, PublishesWhatIsListed) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    make();
    Client client = make_client({.delivery = delivery});
    const ConnectionId connection = connect();
    server_->receive(connection, *client.hello(), now_);
    const auto held = [&](std::uint32_t block) {
      return block_of(texture_.desc(), client.frame().volumes[0].textures[0].texels, block);
    };
    const auto publish = [&](std::vector<std::uint32_t> blocks) {
      now_ += 0.1;
      texture_.fill(Fill::noise, random_);
      ASSERT_EQ(server_->publish(0, 0, std::as_const(texture_).view(), blocks), Status::ok);
      ASSERT_EQ(server_->update(now_, now_), Status::ok);
      exchange(connection, client);
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
    ASSERT_EQ(server_->scroll(0, {1, 0, 0}), Status::ok);
    publish({});
    for (std::uint32_t block = 0; block < kBlocks; ++block) {
      const bool entered = std::ranges::count(entering, block) > 0;
      EXPECT_EQ(held(block) == texture_.block(block), entered) << block;
    }
    EXPECT_EQ(client.statistics().failed_proofs, 0U);
  }
}

/// What exists decides what is read of the rest.
TEST(ServerCalls, RecordsAreReadWherePresenceChanged) {
  World world(4, {2, 1, 1});
  for (std::uint32_t brick = 0; brick < 4; ++brick) world.set_lights(brick, 2);
  Pair pair(world);
  pair.look(0, BlockMask(4, 1));
  world.publish(pair.server());
  pair.update();
  world.set_lights(1, 4);
  const std::uint32_t changed[] = {1};
  const std::uint32_t* const none = nullptr;
  ASSERT_EQ(pair.server().publish(0, 0, std::as_const(world.exists).view(), changed), Status::ok);
  EXPECT_EQ(pair.server().update(1, 1), Status::presence_missing);
  ASSERT_EQ(pair.server().publish(0, 1, std::as_const(world.lights).view(), {none, 0}), Status::ok);
  pair.update();
  EXPECT_EQ(pair.held(0, 1), world.exists.block(1));
  EXPECT_EQ(pair.held(1, 1), world.lights.block(1));
  // A count beyond the block's four.
  Bytes many(world.exists.block(2).size());
  many[0] = std::byte{5};
  world.exists.set_block(2, many);
  ASSERT_EQ(pair.server().publish(0, 0, std::as_const(world.exists).view()), Status::ok);
  EXPECT_EQ(pair.server().publish(0, 1, std::as_const(world.lights).view()),
            Status::presence_invalid);
}

/// Into pitched memory of the caller's, straight from what was decoded; frames have no texels then.
TEST_F(ServerTest, BlocksAreReadToWhereTheyAreNeeded) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    for (const bool texels : {false, true}) {
      make({.region = {2, 2, 2}});
      Client client = make_client({.delivery = delivery, .texels = texels});
      const ConnectionId connection = connect();
      server_->receive(connection, *client.hello(), now_);
      Texture mapped(texture_.desc(), 256, 64);
      std::uint64_t serial = 0;
      for (int i = 0; i < 5; ++i) {
        now_ += 0.1;
        for (const std::uint32_t block : random_selection(random_, kBlocks)) {
          texture_.fill_block(block, Fill::noise, random_);
          if (i % 2 == 0) texture_.fill_band(block);
        }
        ASSERT_EQ(server_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
        ASSERT_EQ(server_->update(now_, now_), Status::ok);
        exchange(connection, client);
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

TEST_F(ServerTest, InterestIsKept) {
  make();
  Client client = make_client();
  BlockMask some(kBlocks);
  some[3] = 1;
  const Viewpoint view{{1, 2, 3}};
  // Before there is a connection.
  ASSERT_EQ(client.set_viewpoint(view), Status::ok);
  ASSERT_EQ(client.subscribe(0, some), Status::ok);
  ASSERT_EQ(client.subscribe(7, some), Status::ok);
  EXPECT_TRUE(client.take_messages().empty());
  for (int session = 0; session < 2; ++session) {
    const ConnectionId connection = connect();
    server_->receive(connection, *client.hello(), now_);
    exchange(connection, client);
    EXPECT_FALSE(client.resumed());
    ASSERT_TRUE(server_->viewpoint(connection).has_value());
    EXPECT_EQ(server_->viewpoint(connection)->eye, view.eye);
    update();
    ASSERT_EQ(server_->packets(connection).size(), 1U);
    EXPECT_EQ(server_->packets(connection)[0].blocks, 1U);
    exchange(connection, client);
    EXPECT_EQ(client.subscribe(7, some), Status::unknown_volume);
    EXPECT_EQ(client.subscribe(0, some, 1), Status::unknown_group);
    EXPECT_EQ(client.subscribe(0, BlockMask(2, 1)), Status::mask_mismatch);
    ASSERT_EQ(client.disconnect(), Status::ok);
    const auto messages = client.take_messages();
    ASSERT_EQ(messages.size(), 1U);
    server_->receive(connection, messages[0], now_);
    EXPECT_EQ(dropped(connection), Reason::left);
    EXPECT_EQ(client.receive(messages[0]), Status::end);
  }
}

/// One packet takes the region's streams to where who lags misses blocks of both kinds.
TEST_F(ServerTest, WhoLagsCatchesUpInAScrollingVolume) {
  make({.region = {8, 8, 8}, .limits = {.max_in_flight = 1}});
  struct Connection {
    Client client;
    ConnectionId id = 0;
    std::vector<Message> replies = {};
  };
  Connection early{make_client({.delivery = Delivery::shared})};
  Connection late{make_client({.delivery = Delivery::shared})};
  for (Connection* connection : {&early, &late}) connection->id = join(connection->client);
  const auto receive = [&] {
    for (Connection* connection : {&early, &late}) {
      for (const Message& message : joined(server_->take_messages(connection->id))) {
        ASSERT_EQ(connection->client.receive(message), Status::ok);
      }
      for (Message& reply : connection->client.take_messages()) {
        connection->replies.push_back(std::move(reply));
      }
    }
  };
  const auto answer = [&](Connection& connection) {
    for (const Message& reply : connection.replies) server_->receive(connection.id, reply, now_);
    connection.replies.clear();
  };
  const auto change = [&](std::vector<std::uint32_t> blocks, std::int32_t scroll) {
    now_ += 0.01;
    for (const std::uint32_t block : blocks) texture_.fill_block(block, Fill::noise, random_);
    ASSERT_EQ(server_->scroll(0, {scroll, 0, 0}), Status::ok);
    ASSERT_EQ(server_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
    ASSERT_EQ(server_->update(now_, now_), Status::ok);
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
  for (const Connection* connection : {&early, &late}) {
    EXPECT_TRUE(connection->client.consistent());
    EXPECT_EQ(connection->client.statistics().failed_proofs, 0U);
    EXPECT_TRUE(std::ranges::equal(connection->client.frame().volumes[0].textures[0].texels,
                                   std::as_const(texture_).view().bytes));
  }
}

/// What stands where a block entered is not known until the renderer says so.
TEST_F(ServerTest, BlocksThatEnteredWaitUntilTheyArePublished) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    make();
    Client client = make_client({.delivery = delivery});
    const ConnectionId connection = join(client);
    const auto next = [&] {
      now_ += 0.1;
      ASSERT_EQ(server_->update(now_, now_), Status::ok);
      exchange(connection, client);
    };
    texture_.fill(Fill::noise, random_);
    ASSERT_EQ(server_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
    for (int i = 0; i < 8; ++i) next();
    EXPECT_EQ(server_->statistics(connection)->pending, 0U);
    ASSERT_EQ(server_->scroll(0, {1, 0, 0}), Status::ok);
    next();
    next();
    const auto& changed = client.frame().volumes[0].textures[0].changed;
    const auto entered = entering_blocks(kGrid, {0, 0, 0}, {1, 0, 0});
    for (const std::uint32_t block : entered) EXPECT_EQ(changed[block], 0U);
    EXPECT_EQ(std::ranges::count(changed, 0U), static_cast<std::ptrdiff_t>(entered.size()));
    ASSERT_EQ(server_->publish(0, 0, std::as_const(texture_).view(), {}), Status::ok);
    for (int i = 0; i < 4; ++i) next();
    EXPECT_EQ(std::ranges::count(changed, 0U), 0);
    EXPECT_TRUE(std::ranges::equal(client.frame().volumes[0].textures[0].texels,
                                   std::as_const(texture_).view().bytes));
  }
}

TEST_F(ServerTest, ViewpointsThatAreNoneAreRefusedAtOnce) {
  make();
  Client client = make_client();
  Viewpoint none;
  none.eye = {std::nanf(""), 0, 0};
  EXPECT_EQ(client.set_viewpoint(none), Status::invalid_argument);
  none = {};
  none.fov_y = 200;
  EXPECT_EQ(client.set_viewpoint(none), Status::invalid_argument);
  const ConnectionId connection = join(client);
  exchange(connection, client);
  EXPECT_TRUE(client.is_connected());
}

TEST_F(ServerTest, ViewpointsAreSentInASession) {
  make();
  Client client = make_client();
  const ConnectionId connection = join(client);
  exchange(connection, client);
  ASSERT_TRUE(client.is_connected());
  ASSERT_EQ(client.set_viewpoint({.time = 7}), Status::ok);
  const auto said = client.take_messages();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(std::get<Viewpoint>(*read_message(said[0])).time, 7);
}

/// What a client has acknowledged, updates build on.
TEST_F(ServerTest, UpdatesBuildOnWhatWasAcknowledged) {
  make();
  Client client = make_client();
  const ConnectionId connection = join(client);
  for (int i = 0; i < 3; ++i) {
    exchange(connection, client);
    update();
  }
  exchange(connection, client);
  texture_.fill_block(3, Fill::noise, random_);
  ASSERT_EQ(server_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
  now_ += 0.1;
  ASSERT_EQ(server_->update(now_, now_), Status::ok);
  std::size_t packets = 0;
  for (const Message& message : joined(server_->take_messages(connection))) {
    const auto read = *read_message(message);
    for (const auto& part : std::get<UpdateMessage>(read).parts) {
      ++packets;
      EXPECT_EQ(peek(part.packet)->blocks, 1U);
      EXPECT_FALSE(is_keyframe(peek(part.packet)->type));
      EXPECT_FALSE(peek(part.packet)->type == PacketType::intra);
    }
  }
  EXPECT_EQ(packets, 1U);
}

TEST_F(ServerTest, RatesBoundAnUpdate) {
  constexpr std::uint32_t kRate = 2000;
  ServerOptions options;
  options.limits.max_bytes_per_second = kRate;
  make(options);
  Client client = make_client();
  const ConnectionId connection = join(client);
  exchange(connection, client);
  update();
  std::size_t bytes = 0;
  for (const Message& message : joined(server_->take_messages(connection))) bytes += message.size();
  EXPECT_GT(bytes, 0U);
  EXPECT_LT(bytes, kRate + block_bytes(texture_.desc()) + 500);
  EXPECT_GT(kBlocks * block_bytes(texture_.desc()), 2 * kRate);
}

/// Renderers know their textures by the instance, whichever server a volume is of.
TEST_F(ServerTest, InstancesAreGivenOnce) {
  Client client = make_client();
  std::vector<std::uint64_t> seen;
  for (int servers = 0; servers < 2; ++servers) {
    make();
    const ConnectionId connection = join(client);
    exchange(connection, client);
    for (int i = 0; i < 2; ++i) {
      update();
      exchange(connection, client);
      ASSERT_EQ(client.frame().volumes.size(), 1U);
      EXPECT_EQ(std::ranges::count(seen, client.frame().volumes[0].instance), i);
      if (i == 0) seen.push_back(client.frame().volumes[0].instance);
    }
  }
  EXPECT_EQ(seen.size(), 2U);
}

}  // namespace
}  // namespace gicodec
