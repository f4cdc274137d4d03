// What the server's limits leave to clients that wait silently, ask again and again, or want
// unicast packets; and which clients get in at all.
#include "../messages.h"
#include "server_fixture.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace gicodec {
namespace {

using namespace test;

/// Asking again and again for what is missing, and acknowledging nothing, does not make the server
/// send more than it would without.
TEST_F(ServerTest, ResyncsDoNotLiftBackPressure) {
  ServerOptions options;
  options.limits.max_in_flight = 4;
  options.timeouts.stall = 60;
  options.limits.resyncs_per_second = 5;
  make(options);
  Client honest = make_client();
  const ConnectionId good = join(honest), bad = connect();
  say(bad, Hello{1});
  say(bad, Subscribe{1, 0, 0, BlockMask(kBlocks, 1)});
  for (std::uint32_t sync = 2; sync < 60; ++sync) {
    update();
    exchange(good, honest);
    say(bad, Resync{sync, 1, {}});
  }
  std::size_t bytes = 0, largest = 0;
  const auto messages = joined(server_->take_messages(bad));
  for (const Message& message : messages) {
    bytes += message.size();
    largest = std::max(largest, message.size());
  }
  EXPECT_GT(messages.size(), 4U);  // Empty ones tell it of its new epochs.
  EXPECT_LE(bytes, 5 * largest + 64 * messages.size());
  expect_others_go_on(good, honest);
}

TEST_F(ServerTest, AfterAResyncWhoLagsCatchesUp) {
  ServerOptions options;
  options.limits.max_in_flight = 2;
  make(options);
  Client client = make_client();
  const ConnectionId connection = join(client);
  for (int i = 0; i < 5; ++i) update();
  auto messages = joined(server_->take_messages(connection));
  ASSERT_EQ(messages.size(), 3U);
  messages.erase(messages.begin() + 1);  // The first update is lost.
  for (const Message& message : messages) ASSERT_EQ(client.receive(message), Status::ok);
  for (const Message& reply : client.take_messages()) server_->receive(connection, reply, now_);
  update();  // An empty one, after which what was on its way counts as arrived.
  exchange(connection, client);
  expect_others_go_on(connection, client);
}

TEST_F(ServerTest, ResyncsHaveARate) {
  ServerOptions options;
  options.limits.resyncs_per_second = 0.5;
  make(options);
  const ConnectionId connection = connect();
  say(connection, Hello{1});
  for (std::uint32_t sync = 2; sync < 7; ++sync) say(connection, Resync{sync, 1, {}});
  EXPECT_EQ(dropped(connection), std::nullopt);
  say(connection, Resync{7, 1, {}});
  EXPECT_EQ(dropped(connection), Reason::flood);
}

/// What a list of blocks costs depends on the volume.
TEST_F(ServerTest, LongSubscriptionsCountForMore) {
  ServerOptions options;
  options.limits.messages_per_second = 20;
  auto server = Server::create(options);
  ASSERT_TRUE(server.ok());
  constexpr Grid kLarge{64, 8, 64};
  const auto volume = probes_of({{"distance", probe_texture(Format::R16_SFLOAT, kLarge, 1, 0)}});
  ASSERT_TRUE(server->add_volume("large", volume, {kLarge}).ok());
  const auto connection = server->connect(0);
  ASSERT_TRUE(connection.ok());
  const auto say = [&](const AnyMessage& message) {
    Message bytes;
    ASSERT_EQ(write_message(message, bytes), Status::ok);
    server->receive(*connection, bytes, 0);
  };
  say(Hello{1});
  // 1 + 2 each; there is room for one of each group besides the 20.
  for (int i = 0; i < 7; ++i) say(Subscribe{1, 0, 0, BlockMask(64 * 8 * 64, 1)});
  EXPECT_TRUE(server->client(*connection).has_value());
  say(Subscribe{1, 0, 0, BlockMask(64 * 8 * 64, 1)});
  EXPECT_FALSE(server->client(*connection).has_value());
  EXPECT_EQ(server->take_events().back().reason, Reason::flood);
}

/// One Subscribe to every group passes at once, however large and however many they are.
TEST_F(ServerTest, EverythingCanBeSubscribedToAtOnce) {
  ServerOptions options;
  options.limits.messages_per_second = 20;
  auto server = Server::create(options);
  ASSERT_TRUE(server.ok());
  constexpr Grid kLarge{128, 64, 64};  // 32 messages' worth.
  const auto volume = probes_of({{"distance", probe_texture(Format::R16_SFLOAT, kLarge, 1, 0)}});
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(server->add_volume("large", volume, {kLarge}).ok());
  const auto connection = server->connect(0);
  const auto say = [&](const AnyMessage& message) {
    Message bytes;
    ASSERT_EQ(write_message(message, bytes), Status::ok);
    server->receive(*connection, bytes, 0);
  };
  say(Hello{1});
  for (std::uint16_t v = 0; v < 3; ++v) {
    say(Subscribe{3, v, 0, BlockMask(block_count(volume.groups[0].textures[0].desc), 1)});
  }
  EXPECT_TRUE(server->client(*connection).has_value());
  say(Subscribe{1, 0, 0, BlockMask(1, 1)});  // Costs as much as a whole one.
  EXPECT_FALSE(server->client(*connection).has_value());
}

/// A way that loses all that is under way and then nothing more: the client finds out and asks.
TEST_F(ServerTest, WhoLostEverythingOnItsWayIsTold) {
  ServerOptions options;
  options.limits.max_in_flight = 3;
  make(options);
  Client client = make_client();
  const ConnectionId connection = join(client);
  update();
  exchange(connection, client);
  for (int i = 0; i < 6; ++i) update();
  EXPECT_EQ(joined(server_->take_messages(connection)).size(), 3U);  // All of them are lost.
  for (int i = 0; i < 30; ++i) {
    update();
    exchange(connection, client);
  }
  EXPECT_EQ(dropped(connection), std::nullopt);
  EXPECT_EQ(server_->statistics(connection)->resyncs, 1U);
  expect_others_go_on(connection, client);
}

/// However many connect and say nothing, who says Hello at once gets in.
TEST_F(ServerTest, SilentConnectionsGiveWay) {
  ServerOptions options;
  options.limits.max_waiting = 3;
  make(options);
  Client honest = make_client();
  std::vector<ConnectionId> silent;
  for (int i = 0; i < 3; ++i) silent.push_back(connect());
  const ConnectionId good = join(honest);
  EXPECT_EQ(dropped(silent[0]), Reason::silent);
  for (int i = 0; i < 3; ++i) silent.push_back(connect());
  update();
  exchange(good, honest);
  expect_others_go_on(good, honest);
}

TEST_F(ServerTest, UnicastSessionsAreLimited) {
  ServerOptions options;
  options.limits.max_unicast = 2;
  make(options);
  const auto hello = [&](Delivery delivery) {
    const ConnectionId connection = connect();
    say(connection, Hello{1, {}, delivery});
    return connection;
  };
  const ConnectionId first = hello(Delivery::unicast), second = hello(Delivery::unicast);
  EXPECT_EQ(dropped(hello(Delivery::unicast)), Reason::unicast_full);
  EXPECT_EQ(dropped(hello(Delivery::shared)), std::nullopt);
  // Who has lost his connection gives way.
  server_->disconnect(first, now_);
  EXPECT_EQ(dropped(hello(Delivery::unicast)), std::nullopt);
  EXPECT_TRUE(server_->client(second).has_value());
}

/// A few origins leave unicast places to others, with connections or without.
TEST_F(ServerTest, UnicastSessionsOfAnOriginAreLimited) {
  ServerOptions options;
  options.limits.max_unicast = 4;
  options.limits.max_unicast_per_origin = 2;
  make(options);
  const auto hello = [&](const char* origin, Delivery delivery = Delivery::unicast) {
    const auto connection = server_->connect(now_, origin);
    EXPECT_TRUE(connection.ok());
    say(*connection, Hello{1, {}, delivery});
    return *connection;
  };
  const ConnectionId a = hello("a");
  hello("a");
  EXPECT_EQ(dropped(hello("a")), Reason::unicast_full);
  EXPECT_EQ(dropped(hello("a", Delivery::shared)), std::nullopt);
  // Its own lost session gives way to it, those of others do not.
  server_->disconnect(a, now_);
  EXPECT_EQ(dropped(hello("a")), std::nullopt);
  const ConnectionId b = hello("b");
  hello("c");
  // Shared sessions that are older are no places for unicast ones.
  for (const char* origin : {"d", "d", "d"}) {
    server_->disconnect(hello(origin, Delivery::shared), now_);
    now_ += 0.1;
  }
  EXPECT_EQ(dropped(hello("e")), Reason::unicast_full);
  server_->disconnect(b, now_);
  EXPECT_EQ(dropped(hello("e")), std::nullopt);
}

/// Who leaves many sessions behind loses them first.
TEST_F(ServerTest, WaitingSessionsOfACrowdGiveWay) {
  make({.limits = {.max_clients = 4}});
  Client honest = make_client();
  const auto honest_connection = server_->connect(now_, "honest");
  ASSERT_TRUE(honest_connection.ok());
  server_->receive(*honest_connection, *honest.hello(), now_);
  exchange(*honest_connection, honest);
  server_->disconnect(*honest_connection, now_);
  for (int i = 0; i < 10; ++i) {
    now_ += 0.1;
    const auto connection = server_->connect(now_, "crowd");
    ASSERT_TRUE(connection.ok());
    say(*connection, Hello{1});
    server_->disconnect(*connection, now_);
  }
  const auto back = server_->connect(now_, "honest");
  ASSERT_TRUE(back.ok());
  server_->receive(*back, *honest.hello(), now_);
  exchange(*back, honest);
  EXPECT_TRUE(honest.resumed());
}

/// unicast blocks are shared out evenly; everybody gets everything by and by.
TEST_F(ServerTest, UnicastBlocksAreShared) {
  make();
  std::vector<Client> clients;
  std::vector<ConnectionId> connections;
  for (int i = 0; i < 3; ++i) connections.push_back(join(clients.emplace_back(make_client())));
  server_->set_limit_for_few(13);
  update();
  for (const ConnectionId connection : connections)
    EXPECT_EQ(server_->statistics(connection)->blocks, 4U);
  for (std::size_t round = 0; round < kBlocks / 4; ++round) {
    for (std::size_t i = 0; i < connections.size(); ++i) exchange(connections[i], clients[i]);
    now_ += 0.1;
    ASSERT_EQ(server_->update(now_, now_), Status::ok);
  }
  for (std::size_t i = 0; i < connections.size(); ++i) {
    exchange(connections[i], clients[i]);
    EXPECT_TRUE(std::ranges::equal(clients[i].frame().volumes[0].textures[0].texels,
                                   std::as_const(texture_).view().bytes));
  }
}

/// With fewer blocks than clients each has its turn, and the others empty updates.
TEST_F(ServerTest, UnicastBlocksAreTakenInTurns) {
  make();
  std::vector<Client> clients;
  std::vector<ConnectionId> connections;
  for (int i = 0; i < 3; ++i) connections.push_back(join(clients.emplace_back(make_client())));
  const auto blocks = [&] {
    std::vector<std::uint64_t> of;
    for (const ConnectionId connection : connections)
      of.push_back(server_->statistics(connection)->blocks);
    return of;
  };
  const auto step = [&](std::uint32_t most) {
    server_->set_limit_for_few(most);
    now_ += 0.1;
    ASSERT_EQ(server_->update(now_, now_), Status::ok);
    for (std::size_t i = 0; i < connections.size(); ++i) exchange(connections[i], clients[i]);
  };
  texture_.fill(Fill::noise, random_);
  ASSERT_EQ(server_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
  for (std::uint64_t round = 1; round <= kBlocks; ++round) {
    step(1);
    const auto of = blocks();
    EXPECT_EQ(std::accumulate(of.begin(), of.end(), std::uint64_t{0}), round);
    EXPECT_LE(*std::ranges::max_element(of) - *std::ranges::min_element(of), 1U);
    EXPECT_EQ(clients[0].frame().serial, clients[2].frame().serial);
  }
  for (std::uint64_t round = 0; round < kBlocks; ++round) step(6);
  EXPECT_EQ(blocks(), std::vector<std::uint64_t>(3, kBlocks));
  // Who has everything leaves its share to others.
  step(6);
  connections.push_back(join(clients.emplace_back(make_client())));
  for (int i = 0; i < 4; ++i) step(2);
  EXPECT_EQ(blocks(), (std::vector<std::uint64_t>{kBlocks, kBlocks, kBlocks, 8}));
}

/// Who acknowledges nothing takes no turns from others.
TEST_F(ServerTest, WhoLagsHasNoTurn) {
  make();
  std::vector<Client> silent;
  for (int i = 0; i < 8; ++i) join(silent.emplace_back(make_client()));
  Client client = make_client();
  const ConnectionId honest = join(client);
  server_->set_limit_for_few(1);
  const auto blocks_of_updates = [&](std::uint32_t updates) {
    const std::uint64_t before = server_->statistics(honest)->blocks;
    texture_.fill(Fill::noise, random_);
    EXPECT_EQ(server_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
    for (std::uint32_t i = 0; i < updates; ++i) {
      now_ += 0.01;
      EXPECT_EQ(server_->update(now_, now_), Status::ok);
      exchange(honest, client);
    }
    return server_->statistics(honest)->blocks - before;
  };
  static_cast<void>(blocks_of_updates(20 * kBlocks));
  EXPECT_EQ(blocks_of_updates(kBlocks), kBlocks);
}

/// Who has all but one block, which changes all the time, gets no more than others.
TEST_F(ServerTest, WhoWantsLittleHasNoMoreTurns) {
  make();
  Client client = make_client();
  const ConnectionId honest = join(client);
  std::vector<Client> few;
  std::vector<ConnectionId> connections;
  for (std::uint32_t i = 0; i < 3; ++i) {
    few.push_back(make_client());
    const auto connection = server_->connect(now_);
    server_->receive(*connection, *few.back().hello(), now_);
    BlockMask one(kBlocks, 0);
    one[i] = 1;
    say(*connection, Subscribe{1, 0, 0, one});
    connections.push_back(*connection);
  }
  const auto step = [&] {
    update();
    exchange(honest, client);
    for (std::size_t i = 0; i < connections.size(); ++i) exchange(connections[i], few[i]);
  };
  for (int i = 0; i < 4; ++i) step();  // without a limit
  server_->set_limit_for_few(1);
  const std::uint64_t before = server_->statistics(honest)->blocks;
  constexpr int kUpdates = 200;
  for (int i = 0; i < kUpdates; ++i) step();
  EXPECT_GT(server_->statistics(honest)->blocks - before, kUpdates / 5U);
}

TEST_F(ServerTest, TimesThatAreNoNumbersAreRefused) {
  make();
  Client client = make_client();
  const ConnectionId connection = join(client);
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    EXPECT_EQ(server_->update(now_, bad), Status::invalid_time);
    EXPECT_EQ(server_->update(bad, now_), Status::invalid_time);
    EXPECT_EQ(server_->connect(bad).status(), Status::invalid_time);
  }
  expect_others_go_on(connection, client);
}

/// An application that knows its users decides on their tokens.
TEST_F(ServerTest, AuthorisesInPlaceOfTheToken) {
  ServerOptions options;
  options.access.token = "not looked at";
  std::vector<ConnectionId> asked;
  options.access.authorise = [&](ConnectionId connection,
                                 std::string_view token) -> std::optional<Reason> {
    asked.push_back(connection);
    if (token == "banned") return Reason::dismissed;
    return token == "ada" ? std::nullopt : std::optional(Reason::token);
  };
  make(options);
  const auto hello = [&](const char* token) {
    const ConnectionId connection = connect();
    Hello said{1};
    said.token = token;
    say(connection, said);
    EXPECT_EQ(asked.back(), connection);
    return connection;
  };
  EXPECT_TRUE(server_->client(hello("ada")).has_value());
  EXPECT_EQ(dropped(hello("not looked at")), Reason::token);
  EXPECT_EQ(dropped(hello("banned")), Reason::dismissed);
  EXPECT_EQ(asked.size(), 3U);
}

}  // namespace
}  // namespace gicodec
