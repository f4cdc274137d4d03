// What the host's limits leave to peers who silently wait, ask again and again, or want packets of
// their own; and who is let in at all.
#include "../messages.h"
#include "host_fixture.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace gicodec {
namespace {

using namespace test;

/// Asking again and again for what is missing, and acknowledging nothing, does not make the server
/// send more than it would without.
TEST_F(HostTest, ResyncsDoNotLiftBackPressure) {
  HostOptions options;
  options.max_in_flight = 4;
  options.stall_timeout = 60;
  options.resyncs_per_second = 5;
  make(options);
  Client honest = make_client();
  const PeerId good = join(honest), bad = connect();
  say(bad, Hello{1});
  say(bad, Subscribe{1, 0, 0, BlockMask(kBlocks, 1)});
  for (std::uint32_t epoch = 2; epoch < 60; ++epoch) {
    update();
    exchange(good, honest);
    say(bad, Resync{epoch, 1, {}});
  }
  std::size_t bytes = 0, largest = 0;
  const auto messages = joined(host_->take_messages(bad));
  for (const Message& message : messages) {
    bytes += message.size();
    largest = std::max(largest, message.size());
  }
  EXPECT_GT(messages.size(), 4U);  // Empty ones tell it of its new epochs.
  EXPECT_LE(bytes, 5 * largest + 64 * messages.size());
  expect_others_go_on(good, honest);
}

TEST_F(HostTest, AfterAResyncWhoIsBehindCatchesUp) {
  HostOptions options;
  options.max_in_flight = 2;
  make(options);
  Client client = make_client();
  const PeerId peer = join(client);
  for (int i = 0; i < 5; ++i) update();
  auto messages = joined(host_->take_messages(peer));
  ASSERT_EQ(messages.size(), 3U);
  messages.erase(messages.begin() + 1);  // The first update is lost.
  for (const Message& message : messages) ASSERT_EQ(client.receive(message), Status::ok);
  for (const Message& reply : client.take_messages()) host_->receive(peer, reply, now_);
  update();  // An empty one, after which what was on its way counts as arrived.
  exchange(peer, client);
  expect_others_go_on(peer, client);
}

TEST_F(HostTest, ResyncsHaveARate) {
  HostOptions options;
  options.resyncs_per_second = 0.5;
  make(options);
  const PeerId peer = connect();
  say(peer, Hello{1});
  for (std::uint32_t epoch = 2; epoch < 7; ++epoch) say(peer, Resync{epoch, 1, {}});
  EXPECT_EQ(dropped(peer), std::nullopt);
  say(peer, Resync{7, 1, {}});
  EXPECT_EQ(dropped(peer), Reason::flood);
}

/// What a list of blocks costs depends on the volume.
TEST_F(HostTest, LongSubscriptionsCountForMore) {
  HostOptions options;
  options.messages_per_second = 20;
  auto host = Host::create(options);
  ASSERT_TRUE(host.ok());
  constexpr Grid kLarge{64, 8, 64};
  const auto volume = probes_of({{"distance", probe_texture(Format::R16_SFLOAT, kLarge, 1, 0)}});
  ASSERT_TRUE(host->add_volume("large", volume, {kLarge}).ok());
  const auto peer = host->connect(0);
  ASSERT_TRUE(peer.ok());
  const auto say = [&](const AnyMessage& message) {
    Message bytes;
    ASSERT_EQ(write_message(message, bytes), Status::ok);
    host->receive(*peer, bytes, 0);
  };
  say(Hello{1});
  // 1 + 2 each; there is room for one of each set besides the 20.
  for (int i = 0; i < 7; ++i) say(Subscribe{1, 0, 0, BlockMask(64 * 8 * 64, 1)});
  EXPECT_TRUE(host->client(*peer).has_value());
  say(Subscribe{1, 0, 0, BlockMask(64 * 8 * 64, 1)});
  EXPECT_FALSE(host->client(*peer).has_value());
  EXPECT_EQ(host->take_events().back().reason, Reason::flood);
}

/// One Subscribe to every set passes at once, however large and however many they are.
TEST_F(HostTest, EverythingCanBeSubscribedToAtOnce) {
  HostOptions options;
  options.messages_per_second = 20;
  auto host = Host::create(options);
  ASSERT_TRUE(host.ok());
  constexpr Grid kLarge{128, 64, 64};  // 32 messages' worth.
  const auto volume = probes_of({{"distance", probe_texture(Format::R16_SFLOAT, kLarge, 1, 0)}});
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(host->add_volume("large", volume, {kLarge}).ok());
  const auto peer = host->connect(0);
  const auto say = [&](const AnyMessage& message) {
    Message bytes;
    ASSERT_EQ(write_message(message, bytes), Status::ok);
    host->receive(*peer, bytes, 0);
  };
  say(Hello{1});
  for (std::uint16_t v = 0; v < 3; ++v) {
    say(Subscribe{3, v, 0, BlockMask(block_count(volume.sets[0].textures[0].desc), 1)});
  }
  EXPECT_TRUE(host->client(*peer).has_value());
  say(Subscribe{1, 0, 0, BlockMask(1, 1)});  // Costs as much as a whole one.
  EXPECT_FALSE(host->client(*peer).has_value());
}

/// A way that loses all that is under way and then nothing more: the client finds out and asks.
TEST_F(HostTest, WhoLostEverythingOnItsWayIsTold) {
  HostOptions options;
  options.max_in_flight = 3;
  make(options);
  Client client = make_client();
  const PeerId peer = join(client);
  update();
  exchange(peer, client);
  for (int i = 0; i < 6; ++i) update();
  EXPECT_EQ(joined(host_->take_messages(peer)).size(), 3U);  // All of them are lost.
  for (int i = 0; i < 30; ++i) {
    update();
    exchange(peer, client);
  }
  EXPECT_EQ(dropped(peer), std::nullopt);
  EXPECT_EQ(host_->statistics(peer)->resyncs, 1U);
  expect_others_go_on(peer, client);
}

/// However many connect and say nothing, who says Hello at once gets in.
TEST_F(HostTest, SilentPeersGiveWay) {
  HostOptions options;
  options.max_waiting = 3;
  make(options);
  Client honest = make_client();
  std::vector<PeerId> silent;
  for (int i = 0; i < 3; ++i) silent.push_back(connect());
  const PeerId good = join(honest);
  EXPECT_EQ(dropped(silent[0]), Reason::silent);
  for (int i = 0; i < 3; ++i) silent.push_back(connect());
  update();
  exchange(good, honest);
  expect_others_go_on(good, honest);
}

TEST_F(HostTest, OwnSessionsAreLimited) {
  HostOptions options;
  options.max_own = 2;
  make(options);
  const auto hello = [&](Delivery delivery) {
    const PeerId peer = connect();
    say(peer, Hello{1, {}, delivery});
    return peer;
  };
  const PeerId first = hello(Delivery::own), second = hello(Delivery::own);
  EXPECT_EQ(dropped(hello(Delivery::own)), Reason::own_full);
  EXPECT_EQ(dropped(hello(Delivery::shared)), std::nullopt);
  // Who has lost his connection gives way.
  host_->disconnect(first, now_);
  EXPECT_EQ(dropped(hello(Delivery::own)), std::nullopt);
  EXPECT_TRUE(host_->client(second).has_value());
}

/// A few origins leave own places to others, with connections or without.
TEST_F(HostTest, OwnSessionsOfAnOriginAreLimited) {
  HostOptions options;
  options.max_own = 4;
  options.max_own_per_origin = 2;
  make(options);
  const auto hello = [&](const char* origin, Delivery delivery = Delivery::own) {
    const auto peer = host_->connect(now_, origin);
    EXPECT_TRUE(peer.ok());
    say(*peer, Hello{1, {}, delivery});
    return *peer;
  };
  const PeerId a = hello("a");
  hello("a");
  EXPECT_EQ(dropped(hello("a")), Reason::own_full);
  EXPECT_EQ(dropped(hello("a", Delivery::shared)), std::nullopt);
  // Its own lost session gives way to it, those of others do not.
  host_->disconnect(a, now_);
  EXPECT_EQ(dropped(hello("a")), std::nullopt);
  const PeerId b = hello("b");
  hello("c");
  // Shared sessions that are older are no places for own ones.
  for (const char* origin : {"d", "d", "d"}) {
    host_->disconnect(hello(origin, Delivery::shared), now_);
    now_ += 0.1;
  }
  EXPECT_EQ(dropped(hello("e")), Reason::own_full);
  host_->disconnect(b, now_);
  EXPECT_EQ(dropped(hello("e")), std::nullopt);
}

/// Who leaves many sessions behind loses them first.
TEST_F(HostTest, WaitingSessionsOfACrowdGiveWay) {
  make({.max_clients = 4});
  Client honest = make_client();
  const auto honest_peer = host_->connect(now_, "honest");
  ASSERT_TRUE(honest_peer.ok());
  host_->receive(*honest_peer, *honest.hello(), now_);
  exchange(*honest_peer, honest);
  host_->disconnect(*honest_peer, now_);
  for (int i = 0; i < 10; ++i) {
    now_ += 0.1;
    const auto peer = host_->connect(now_, "crowd");
    ASSERT_TRUE(peer.ok());
    say(*peer, Hello{1});
    host_->disconnect(*peer, now_);
  }
  const auto back = host_->connect(now_, "honest");
  ASSERT_TRUE(back.ok());
  host_->receive(*back, *honest.hello(), now_);
  exchange(*back, honest);
  EXPECT_TRUE(honest.resumed());
}

/// Blocks of own packets are shared out evenly; everybody gets everything by and by.
TEST_F(HostTest, OwnBlocksAreShared) {
  make();
  std::vector<Client> clients;
  std::vector<PeerId> peers;
  for (int i = 0; i < 3; ++i) peers.push_back(join(clients.emplace_back(make_client())));
  host_->set_extra_blocks(13);
  update();
  for (const PeerId peer : peers) EXPECT_EQ(host_->statistics(peer)->blocks, 4U);
  for (std::size_t round = 0; round < kBlocks / 4; ++round) {
    for (std::size_t i = 0; i < peers.size(); ++i) exchange(peers[i], clients[i]);
    now_ += 0.1;
    ASSERT_EQ(host_->update(now_, now_), Status::ok);
  }
  for (std::size_t i = 0; i < peers.size(); ++i) {
    exchange(peers[i], clients[i]);
    EXPECT_TRUE(std::ranges::equal(clients[i].frame().volumes[0].textures[0].texels,
                                   std::as_const(texture_).view().bytes));
  }
}

/// With fewer blocks than clients each has its turn, and the others empty updates.
TEST_F(HostTest, OwnBlocksAreTakenInTurns) {
  make();
  std::vector<Client> clients;
  std::vector<PeerId> peers;
  for (int i = 0; i < 3; ++i) peers.push_back(join(clients.emplace_back(make_client())));
  const auto blocks = [&] {
    std::vector<std::uint64_t> of;
    for (const PeerId peer : peers) of.push_back(host_->statistics(peer)->blocks);
    return of;
  };
  const auto step = [&](std::uint32_t most) {
    host_->set_extra_blocks(most);
    now_ += 0.1;
    ASSERT_EQ(host_->update(now_, now_), Status::ok);
    for (std::size_t i = 0; i < peers.size(); ++i) exchange(peers[i], clients[i]);
  };
  texture_.fill(Fill::noise, random_);
  ASSERT_EQ(host_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
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
  peers.push_back(join(clients.emplace_back(make_client())));
  for (int i = 0; i < 4; ++i) step(2);
  EXPECT_EQ(blocks(), (std::vector<std::uint64_t>{kBlocks, kBlocks, kBlocks, 8}));
}

/// Who acknowledges nothing takes no turns from others.
TEST_F(HostTest, WhoIsBehindHasNoTurn) {
  make();
  std::vector<Client> silent;
  for (int i = 0; i < 8; ++i) join(silent.emplace_back(make_client()));
  Client client = make_client();
  const PeerId honest = join(client);
  host_->set_extra_blocks(1);
  const auto blocks_of_updates = [&](std::uint32_t updates) {
    const std::uint64_t before = host_->statistics(honest)->blocks;
    texture_.fill(Fill::noise, random_);
    EXPECT_EQ(host_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
    for (std::uint32_t i = 0; i < updates; ++i) {
      now_ += 0.01;
      EXPECT_EQ(host_->update(now_, now_), Status::ok);
      exchange(honest, client);
    }
    return host_->statistics(honest)->blocks - before;
  };
  static_cast<void>(blocks_of_updates(20 * kBlocks));
  EXPECT_EQ(blocks_of_updates(kBlocks), kBlocks);
}

/// Who has all but one block, which changes all the time, gets no more than others.
TEST_F(HostTest, WhoWantsLittleHasNoMoreTurns) {
  make();
  Client client = make_client();
  const PeerId honest = join(client);
  std::vector<Client> few;
  std::vector<PeerId> peers;
  for (std::uint32_t i = 0; i < 3; ++i) {
    few.push_back(make_client());
    const auto peer = host_->connect(now_);
    host_->receive(*peer, *few.back().hello(), now_);
    BlockMask one(kBlocks, 0);
    one[i] = 1;
    say(*peer, Subscribe{1, 0, 0, one});
    peers.push_back(*peer);
  }
  const auto step = [&] {
    update();
    exchange(honest, client);
    for (std::size_t i = 0; i < peers.size(); ++i) exchange(peers[i], few[i]);
  };
  for (int i = 0; i < 4; ++i) step();  // without a limit
  host_->set_extra_blocks(1);
  const std::uint64_t before = host_->statistics(honest)->blocks;
  constexpr int kUpdates = 200;
  for (int i = 0; i < kUpdates; ++i) step();
  EXPECT_GT(host_->statistics(honest)->blocks - before, kUpdates / 5U);
}

TEST_F(HostTest, TimesThatAreNoNumbersAreRefused) {
  make();
  Client client = make_client();
  const PeerId peer = join(client);
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    EXPECT_EQ(host_->update(now_, bad), Status::invalid_time);
    EXPECT_EQ(host_->update(bad, now_), Status::invalid_time);
    EXPECT_EQ(host_->connect(bad).status(), Status::invalid_time);
  }
  expect_others_go_on(peer, client);
}

/// An application that knows its users decides on their tokens.
TEST_F(HostTest, AuthorisesInPlaceOfTheToken) {
  HostOptions options;
  options.token = "not looked at";
  std::vector<PeerId> asked;
  options.authorise = [&](PeerId peer, std::string_view token) -> std::optional<Reason> {
    asked.push_back(peer);
    if (token == "banned") return Reason::dismissed;
    return token == "ada" ? std::nullopt : std::optional(Reason::token);
  };
  make(options);
  const auto hello = [&](const char* token) {
    const PeerId peer = connect();
    Hello said{1};
    said.token = token;
    say(peer, said);
    EXPECT_EQ(asked.back(), peer);
    return peer;
  };
  EXPECT_TRUE(host_->client(hello("ada")).has_value());
  EXPECT_EQ(dropped(hello("not looked at")), Reason::token);
  EXPECT_EQ(dropped(hello("banned")), Reason::dismissed);
  EXPECT_EQ(asked.size(), 3U);
}

}  // namespace
}  // namespace gicodec
