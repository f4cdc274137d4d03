// What a client is told of a volume: its kind, the publisher's epoch, how often its parts come.
#include "../messages.h"
#include "session/bricks.h"

namespace gicodec {
namespace {

using namespace test;

TEST(SessionVolumes, AKindOfTheApplicationsOwnGoesOverTheWire) {
  World world(5, {2, 1, 1});
  world.set_lights(3, 4);
  world.name(1, 3);
  ClientOptions options;
  Pair pair(world, options);
  pair.look(0, BlockMask(5, 1));
  pair.look(1, BlockMask(2, 1));
  world.publish(pair.server());
  pair.update();
  EXPECT_EQ(pair.volume().desc, world.volume);
  EXPECT_EQ(pair.held(1, 3), world.lights.block(3));
  EXPECT_EQ(pair.held(2, 1), world.cells.block(1));

  // A server that does not know it does not take it, nor does a client.
  auto ignorant = *Server::create({.backend = "raw"});
  EXPECT_EQ(ignorant.add_volume("bricks", world.volume, {{5, 1, 1}}).status(),
            Status::unknown_kind);
  auto client = *Client::create();
  const ConnectionId connection = *pair.server().connect(1);
  pair.server().receive(connection, *client.hello(), 1);
  const auto messages = joined(pair.server().take_messages(connection));
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(client.receive(messages[0]), Status::unknown_kind);
}

/// What a server tells of volumes is what its server does with them.
TEST(SessionVolumes, ServersKnowTheirVolumes) {
  const auto probes = probes_of({{"color", ddgi_irradiance({2, 2, 2})}});
  const VolumeGeometry geometry{{2, 2, 2}};
  auto server = *Server::create({.backend = "raw"});
  ASSERT_TRUE(server.add_volume("probes", probes, geometry).ok());
  EXPECT_EQ(server.geometry(1).status(), Status::unknown_volume);
  ASSERT_EQ(server.scroll(0, {1, 0, 0}), Status::ok);
  EXPECT_EQ(server.geometry(0)->scroll, (Scroll{1, 0, 0}));
  auto client = *Client::create();
  const ConnectionId connection = *server.connect(0);
  server.receive(connection, *client.hello(), 0);
  ASSERT_EQ(server.scroll(0, {1, 1, 0}), Status::ok);
  const Bytes black(texture_bytes(probes.groups[0].textures[0].desc));
  ASSERT_EQ(server.publish(0, 0, ConstTextureView(black)), Status::ok);
  ASSERT_EQ(server.update(0, 0), Status::ok);
  for (const Message& message : joined(server.take_messages(connection))) {
    ASSERT_EQ(client.receive(message), Status::ok);
  }
  EXPECT_EQ(client.frame().volumes[0].geometry.scroll, (Scroll{1, 1, 0}));
}

/// A kind that cannot read what it writes would fail at every client.
TEST(SessionVolumes, KindsReadWhatTheyWrite) {
  constexpr Kind kForgetful{kKindBricks, "bricks", write_bricks,
                            [](std::span<const std::byte>) -> Result<VolumeDesc> {
                              return bricks(9, {1, 1, 1});
                            },
                            nullptr};
  constexpr Kind kLying{kKindBricks, "bricks",
                        [](const VolumeDesc&, std::vector<std::byte>&) { return Status::end; },
                        read_bricks, nullptr};
  for (const Kind* kind : {&kForgetful, &kLying}) {
    ServerOptions options;
    options.kinds = {kind};
    auto server = *Server::create(options);
    EXPECT_EQ(server.add_volume("bricks", bricks(4, {2, 1, 1}), {{4, 1, 1}}).status(),
              Status::invalid_description);
  }
}

/// Who comes back to another run of the server begins anew, whatever it shows.
TEST(SessionVolumes, AnotherEpochOfThePublisherBeginsAnew) {
  World world(3, {1, 1, 1});
  std::optional<Client> client;
  std::uint64_t began = 0;
  for (const std::uint64_t epoch : {7U, 9U}) {
    ServerOptions options;
    options.epoch = epoch;
    options.kinds = {&kBricks};
    auto server = *Server::create(options);
    ASSERT_TRUE(server.add_volume("bricks", world.volume, {{3, 1, 1}}).ok());
    if (!client) {
      ClientOptions of_client;
      of_client.kinds = {&kBricks};
      client.emplace(*Client::create(of_client));
    }
    const ConnectionId connection = *server.connect(0);
    server.receive(connection, *client->hello(), 0);
    ASSERT_EQ(server.set_visible(connection, 0, BlockMask(3, 1)), Status::ok);
    world.publish(server);
    ASSERT_EQ(server.update(0, 0), Status::ok);
    for (const Message& message : joined(server.take_messages(connection))) {
      ASSERT_EQ(client->receive(message), Status::ok);
    }
    EXPECT_FALSE(client->resumed());
    EXPECT_TRUE(client->consistent());
    EXPECT_EQ(client->frame().epoch, epoch);
    EXPECT_GT(client->frame().began, began);
    began = client->frame().began;
  }
}

/// A server that claims to go on with a session of another epoch is not believed.
TEST(SessionVolumes, ASessionOfAnotherEpochDoesNotGoOn) {
  World world(3, {1, 1, 1});
  Pair pair(world);
  pair.update();
  ASSERT_TRUE(pair.client().consistent());
  pair.server().disconnect(pair.connection(), 1);
  pair.connect();
  auto messages = joined(pair.server().take_messages(pair.connection()));
  ASSERT_EQ(messages.size(), 1U);
  auto welcome = std::get<Welcome>(*read_message(messages[0]));
  ASSERT_TRUE(welcome.resumed);
  ++welcome.epoch;
  ASSERT_EQ(write_message(welcome, messages[0]), Status::ok);
  EXPECT_EQ(pair.client().receive(messages[0]), Status::corrupt);
}

/// Whoever draws loops over the records that exist, so a server that lies about them is left.
TEST(SessionVolumes, PresenceThatLiesIsCorrupt) {
  for (const std::uint16_t lie : {std::uint16_t{1}, std::uint16_t{5}, std::uint16_t{60000}}) {
    World world(3, {1, 1, 1});
    for (std::uint32_t brick = 0; brick < 3; ++brick) world.set_lights(brick, 3);
    ServerOptions server_options;
    server_options.kinds = {&kBricks};
    auto server = *Server::create(server_options);
    ASSERT_TRUE(server.add_volume("bricks", world.volume, {{3, 1, 1}}).ok());
    ClientOptions options;
    options.kinds = {&kBricks};
    auto client = *Client::create(options);
    const ConnectionId connection = *server.connect(0);
    server.receive(connection, *client.hello(), 0);
    ASSERT_EQ(client.receive(joined(server.take_messages(connection)).at(0)), Status::ok);

    EncoderOptions encoder_options;
    encoder_options.backend = "raw";
    auto exists = *Encoder::create(world.exists.desc(), encoder_options);
    encoder_options.texture_id = 1;
    auto lights = *Encoder::create(world.lights.desc(), encoder_options);
    UpdateMessage update;
    update.generation = 1;
    update.sync = 1;
    update.scrolls.resize(1);
    const auto send = [&] {
      ++update.number;
      Message message;
      EXPECT_EQ(write_message(update, message), Status::ok);
      return client.receive(message);
    };
    const auto counts = std::as_const(world.exists).view();
    ASSERT_EQ(lights.set_presence(counts.bytes), Status::ok);
    const Packet all_exists = *exists.encode(counts);
    const Packet all_lights = *lights.encode(std::as_const(world.lights).view());
    update.parts = {{{0, 0}, 0, all_exists}, {{0, 1}, 0, all_lights}};
    ASSERT_EQ(send(), Status::ok);
    ASSERT_TRUE(client.consistent());

    world.exists.set_block(1, std::as_bytes(std::span(&lie, 1)));
    const Packet one_lies = *exists.encode(std::as_const(world.exists).view());
    update.parts = {{{0, 0}, 0, one_lies}};
    EXPECT_EQ(send(), Status::corrupt) << lie;
    EXPECT_FALSE(client.consistent());
  }
}

/// Parts say in which updates their streams come.
TEST(SessionVolumes, PartsTellTheirTier) {
  constexpr Grid kGrid{8, 4, 8};
  Texture texture_of(ddgi_irradiance(kGrid));
  auto server = *Server::create({.backend = "raw", .region = {2, 4, 2}});
  ASSERT_TRUE(server.add_volume("probes", probes_of({{"color", texture_of.desc()}}), {kGrid}).ok());
  ClientOptions options;
  options.delivery = Delivery::shared;
  options.budget.bytes = 8000;  // An eighth or less of what changes.
  auto client = *Client::create(options);
  const ConnectionId connection = *server.connect(0);
  server.receive(connection, *client.hello(), 0);
  ASSERT_EQ(server.set_visible(connection, 0, BlockMask(256, 1)), Status::ok);
  Random random(3);
  std::map<StreamId, std::vector<std::pair<int, unsigned>>> seen;
  for (int update = 0; update < 100; ++update) {
    texture_of.fill(Fill::noise, random);
    ASSERT_EQ(server.publish(0, 0, std::as_const(texture_of).view()), Status::ok);
    const double now = 0.1 * update;
    ASSERT_EQ(server.update(now, now), Status::ok);
    for (const Message& message : joined(server.take_messages(connection))) {
      const auto read = read_message(message);
      if (const auto* said = std::get_if<UpdateMessage>(&*read)) {
        for (const auto& part : said->parts) seen[part.stream].emplace_back(update, part.tier);
      }
      ASSERT_EQ(client.receive(message), Status::ok);
    }
    for (const Message& reply : client.take_messages()) server.receive(connection, reply, now);
  }
  std::uint32_t slow = 0;
  for (const auto& [stream, times] : seen) {
    for (std::size_t i = 1; i < times.size(); ++i) {
      if (times[i].second == 0 || times[i].second != times[i - 1].second) continue;
      EXPECT_EQ((times[i].first - times[i - 1].first) % (1 << times[i].second), 0);
      ++slow;
    }
  }
  EXPECT_GT(slow, 20U);
}

}  // namespace
}  // namespace gicodec
