// Clients that do not behave are dropped with a reason, and nobody else notices.
#include "../messages.h"
#include "server_fixture.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace gicodec {
namespace {

using namespace test;

TEST_F(ServerTest, DropsWhoBreaksTheProtocol) {
  make();
  Client honest = make_client();
  const ConnectionId good = join(honest);
  update();
  exchange(good, honest);
  const auto drop_reason = [&](auto&& misbehave) {
    const ConnectionId connection = connect();
    misbehave(connection);
    const auto reason = dropped(connection);
    EXPECT_TRUE(reason.has_value());
    server_->disconnect(connection, now_);
    return reason.value_or(Reason::left);
  };
  const auto hello = [&](ConnectionId connection) { say(connection, Hello{1}); };

  EXPECT_EQ(drop_reason([&](ConnectionId p) { server_->receive(p, noise(random_, 100), now_); }),
            Reason::malformed);
  EXPECT_EQ(drop_reason([&](ConnectionId p) { server_->receive(p, {}, now_); }), Reason::malformed);
  EXPECT_EQ(drop_reason([&](ConnectionId p) { server_->receive(p, Message((1 << 20) + 1), now_); }),
            Reason::too_large);
  EXPECT_EQ(drop_reason([&](ConnectionId p) { say(p, Acknowledge{1, 1}); }), Reason::out_of_order);
  EXPECT_EQ(drop_reason([&](ConnectionId p) { say(p, Resync{1, 1, {}}); }), Reason::out_of_order);
  EXPECT_EQ(drop_reason([&](ConnectionId p) { say(p, Viewpoint{}); }), Reason::out_of_order);
  EXPECT_EQ(drop_reason([&](ConnectionId p) { say(p, Subscribe{}); }), Reason::out_of_order);
  EXPECT_EQ(
      drop_reason([&](ConnectionId p) { say(p, Welcome{.ticket = {std::byte{1}}, .epoch = 1}); }),
      Reason::out_of_order);
  EXPECT_EQ(drop_reason([&](ConnectionId p) { hello(p), hello(p); }), Reason::out_of_order);
  EXPECT_EQ(drop_reason([&](ConnectionId p) {
              hello(p), say(p, Acknowledge{2, 1});
            }),
            Reason::out_of_order);
  EXPECT_EQ(drop_reason([&](ConnectionId p) {
              hello(p), say(p, Acknowledge{1, 1});
            }),
            Reason::malformed);
  EXPECT_EQ(drop_reason([&](ConnectionId p) {
              hello(p), say(p, Subscribe{1, 1, 0, BlockMask(kBlocks, 1)});
            }),
            Reason::unknown_volume);
  EXPECT_EQ(drop_reason([&](ConnectionId p) {
              hello(p), say(p, Subscribe{1, 0, 0, BlockMask(3, 1)});
            }),
            Reason::malformed);
  EXPECT_EQ(drop_reason([&](ConnectionId p) {
              hello(p), say(p, Resync{2, 1, {{{7, 0}, 1, 1}}});
            }),
            Reason::unknown_volume);
  EXPECT_EQ(drop_reason([&](ConnectionId p) {
              hello(p), say(p, Resync{2, 1, {{{0, 0}, 1, 1}, {{0, 0}, 1, 1}}});
            }),
            Reason::malformed);
  EXPECT_EQ(drop_reason([&](ConnectionId p) { hello(p), say(p, Goodbye{}); }), Reason::left);
  EXPECT_EQ(drop_reason([&](ConnectionId p) {
              Message other;
              ASSERT_EQ(write_message(Hello{}, other), Status::ok);
              other[5] = std::byte{99};
              server_->receive(p, other, now_);
            }),
            Reason::version);
  EXPECT_EQ(*server_->connections(), std::vector<ConnectionId>{good});
  expect_others_go_on(good, honest);
}

TEST_F(ServerTest, DropsWhoFloods) {
  make({.limits = {.messages_per_second = 50}});
  Client honest = make_client();
  const ConnectionId good = join(honest);
  const ConnectionId bad = connect();
  say(bad, Hello{1});
  for (int i = 0; i < 60; ++i) say(bad, Viewpoint{});
  EXPECT_EQ(dropped(bad), Reason::flood);
  expect_others_go_on(good, honest);
}

TEST_F(ServerTest, KeepsToItsLimitForWhoNeverReads) {
  make({.limits = {.max_in_flight = 4, .max_in_flight_bytes = 1 << 20}, .timeouts = {.stall = 3}});
  Client honest = make_client();
  const ConnectionId good = join(honest);
  const ConnectionId bad = connect();
  say(bad, Hello{1});
  say(bad, Subscribe{1, 0, 0, BlockMask(kBlocks, 1)});
  std::size_t most = 0;
  std::optional<Reason> reason;
  for (int i = 0; i < 40 && !reason; ++i) {
    update();
    exchange(good, honest);
    if (const auto statistics = server_->statistics(bad)) {
      EXPECT_LE(statistics->in_flight, 4U);
    }
    most = std::max(most, server_->memory());
    reason = dropped(bad);
  }
  EXPECT_EQ(reason, Reason::stalled);
  EXPECT_LT(most, 4U << 20);
  expect_others_go_on(good, honest);
}

TEST_F(ServerTest, PassesOverWhoIsSlowAndCatchesUpLater) {
  make({.limits = {.max_in_flight = 4}});
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    ClientOptions options;
    options.delivery = delivery;
    Client client = make_client(options);
    const ConnectionId connection = join(client);
    for (int i = 0; i < 10; ++i) update();
    EXPECT_TRUE(server_->statistics(connection)->lagging);
    // Before anything is acknowledged, two are as much as may be on their way.
    EXPECT_EQ(server_->statistics(connection)->skipped, 8U);
    exchange(connection, client);
    expect_others_go_on(connection, client);
    EXPECT_FALSE(server_->statistics(connection)->lagging);
  }
}

TEST_F(ServerTest, DropsWhoStaysSilent) {
  make({.timeouts = {.hello = 2}});
  const ConnectionId connection = connect();
  now_ += 1;
  server_->tick(now_);
  EXPECT_FALSE(dropped(connection).has_value());
  now_ += 1.5;
  server_->tick(now_);
  EXPECT_EQ(dropped(connection), Reason::silent);
}

TEST_F(ServerTest, AsksForTheToken) {
  make({.access = {.token = "open sesame"}});
  for (const char* token : {"", "open sesam", "open sesame!", "Open sesame"}) {
    const ConnectionId connection = connect();
    say(connection, Hello{.sync = 1, .token = token});
    EXPECT_EQ(dropped(connection), Reason::token) << token;
  }
  ClientOptions options;
  options.token = "open sesame";
  Client client = make_client(options);
  const ConnectionId connection = join(client);
  expect_others_go_on(connection, client);
}

TEST_F(ServerTest, TakesNoMoreThanItMay) {
  make({.limits = {.max_clients = 2, .max_connections = 3}});
  Client first = make_client(), second = make_client(), third = make_client();
  const ConnectionId one = join(first);
  join(second);
  const ConnectionId three = join(third);
  EXPECT_EQ(dropped(three), Reason::full);
  EXPECT_EQ(server_->connect(now_).status(), Status::limit_exceeded);
  // A session without a connection makes room.
  server_->disconnect(three, now_);
  server_->disconnect(one, now_);
  join(third);
  EXPECT_EQ(server_->connections()->size(), 2U);
}

TEST_F(ServerTest, AClientComesBackWithoutAKeyframe) {
  make({.timeouts = {.linger = 5}});
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    ClientOptions options;
    options.delivery = delivery;
    Client client = make_client(options);
    ConnectionId connection = join(client);
    update();
    exchange(connection, client);
    const std::uint64_t packets = client.statistics().packets;
    // What is under way is lost with the connection.
    if (delivery == Delivery::unicast) update();
    server_->disconnect(connection, now_);
    now_ += 1;
    connection = connect();
    const auto hello = client.hello();
    ASSERT_TRUE(hello.ok());
    server_->receive(connection, *hello, now_);
    ASSERT_EQ(server_->update(now_, now_), Status::ok);  // Nothing has changed since.
    std::uint32_t keyframes = 0;
    for (const Message& message : joined(server_->take_messages(connection))) {
      const auto read = read_message(message);
      ASSERT_TRUE(read.ok());
      if (const auto* update = std::get_if<UpdateMessage>(&*read)) {
        for (const auto& part : update->parts) keyframes += is_keyframe(peek(part.packet)->type);
      }
      ASSERT_EQ(client.receive(message), Status::ok);
    }
    EXPECT_TRUE(client.resumed());
    EXPECT_EQ(keyframes, 0U);
    EXPECT_EQ(client.statistics().packets, packets + (delivery == Delivery::unicast ? 1 : 0));
    for (const Message& reply : client.take_messages()) server_->receive(connection, reply, now_);
    expect_others_go_on(connection, client);
  }
}

TEST_F(ServerTest, ForgetsWhoDoesNotComeBack) {
  make({.timeouts = {.linger = 5}});
  Client client = make_client();
  ConnectionId connection = join(client);
  update();
  exchange(connection, client);
  server_->disconnect(connection, now_);
  now_ += 6;
  server_->tick(now_);
  const auto events = server_->take_events();
  EXPECT_EQ(events.back().type, ServerEvent::Type::expired);
  connection = join(client);
  update();
  exchange(connection, client);
  EXPECT_FALSE(client.resumed());
  expect_others_go_on(connection, client);
}

TEST_F(ServerTest, ASessionMovesToItsNewConnection) {
  make();
  Client client = make_client();
  const ConnectionId before = join(client);
  update();
  exchange(before, client);
  const ConnectionId connection = connect();
  const auto hello = client.hello();
  ASSERT_TRUE(hello.ok());
  server_->receive(connection, *hello, now_);
  EXPECT_EQ(dropped(before), Reason::replaced);
  expect_others_go_on(connection, client);
  EXPECT_TRUE(client.resumed());
}

TEST_F(ServerTest, AsksForWhatWasLost) {
  make();
  Client client = make_client();
  const ConnectionId connection = join(client);
  update();
  exchange(connection, client);
  const ClientFrame held = client.frame();
  update();
  EXPECT_EQ(joined(server_->take_messages(connection)).size(), 1U);  // Lost.
  update();
  exchange(connection, client);
  EXPECT_FALSE(client.consistent());
  EXPECT_EQ(client.statistics().gaps, 1U);
  EXPECT_EQ(client.frame().volumes[0].textures[0].texels, held.volumes[0].textures[0].texels);
  expect_others_go_on(connection, client);
  EXPECT_EQ(server_->statistics(connection)->resyncs, 1U);
}

TEST_F(ServerTest, ATicketIsGoodForOneReturn) {
  make({.scene = {"hall", 77}});
  const auto ticket_after = [&](const Hello& hello, bool& resumed) {
    const ConnectionId connection = connect();
    say(connection, hello);
    const auto messages = joined(server_->take_messages(connection));
    const auto read = read_message(messages.at(0));
    const auto* welcome = std::get_if<Welcome>(&*read);
    EXPECT_NE(welcome, nullptr);
    EXPECT_EQ(welcome->scene, (SceneId{"hall", 77}));
    resumed = welcome->resumed;
    server_->disconnect(connection, now_);
    return welcome->ticket;
  };
  bool resumed = false;
  const Ticket first = ticket_after(Hello{1}, resumed);
  EXPECT_FALSE(resumed);
  Ticket almost = first;
  almost.back() ^= std::byte{1};
  for (const Ticket& wrong : {Ticket{}, almost}) {
    EXPECT_NE(ticket_after(Hello{1, wrong}, resumed), first);
    EXPECT_FALSE(resumed);
  }
  const Ticket second = ticket_after(Hello{1, first}, resumed);
  EXPECT_TRUE(resumed);
  EXPECT_NE(second, first);
  EXPECT_NE(ticket_after(Hello{1, first}, resumed), second);  // Used up.
  EXPECT_FALSE(resumed);
  ticket_after(Hello{1, second}, resumed);
  EXPECT_TRUE(resumed);
}

TEST_F(ServerTest, ATicketDiesWithItsSession) {
  make();
  ConnectionId connection = connect();
  say(connection, Hello{1});
  const auto messages = joined(server_->take_messages(connection));
  const auto read = read_message(messages.at(0));
  const Ticket ticket = std::get<Welcome>(*read).ticket;
  say(connection, Goodbye{});
  connection = connect();
  say(connection, Hello{1, ticket});
  server_->disconnect(connection, now_);
  for (const ServerEvent& event : server_->take_events()) {
    EXPECT_NE(event.type, ServerEvent::Type::resumed);
  }
}

/// All that a source gives goes into tickets, and nothing else does.
TEST_F(ServerTest, TicketsAreDrawnFromTheSourceOfRandomness) {
  int drawn = 0;
  Status answer = Status::ok;
  std::byte value{1};
  ServerOptions options;
  options.access.random = [&](std::span<std::byte> out) {
    ++drawn;
    std::ranges::fill(out, value);
    return answer;
  };
  make(options);
  ConnectionId connection = connect();
  say(connection, Hello{1});
  const auto messages = joined(server_->take_messages(connection));
  const auto read = read_message(messages.at(0));
  Ticket ones;
  ones.fill(std::byte{1});
  EXPECT_EQ(std::get<Welcome>(*read).ticket, ones);
  EXPECT_EQ(std::get<Welcome>(*read).epoch, 0x0101010101010101U);
  EXPECT_EQ(drawn, 3);  // Once to see that there is a source, and for the epoch.

  const auto turned_away = [&] {
    const ConnectionId other = connect();
    say(other, Hello{1});
    return dropped(other);
  };
  static_cast<void>(server_->take_events());
  EXPECT_EQ(turned_away(), Reason::full);  // The same again.
  value = std::byte{0};
  EXPECT_EQ(turned_away(), Reason::full);
  value = std::byte{2};
  answer = Status::io_failed;
  EXPECT_EQ(turned_away(), Reason::full);
  answer = Status::ok;
  EXPECT_EQ(turned_away(), std::nullopt);

  value = std::byte{0};
  EXPECT_EQ(Server::create(options).status(), Status::backend_failed);
  options.epoch = 5;
  EXPECT_TRUE(Server::create(options).ok());
  answer = Status::io_failed;
  EXPECT_EQ(Server::create(options).status(), Status::io_failed);
}

TEST_F(ServerTest, NamesAreUtf8) {
  ServerOptions options;
  options.scene.name = "\xff";
  EXPECT_EQ(Server::create(options).status(), Status::invalid_name);
  auto server = Server::create();
  const auto add = [&](const std::string& name, const char* texture) {
    VolumeDesc volume = probes_of({{"color", texture_.desc()}});
    volume.groups[0].textures[0].name = texture;
    return server->add_volume(name, volume, {kGrid}).status();
  };
  EXPECT_EQ(add("\xff", "color"), Status::invalid_name);
  EXPECT_EQ(add("world", "\xC3"), Status::invalid_description);
  EXPECT_EQ(add("world", "color"), Status::ok);
}

TEST_F(ServerTest, KeepsEveryClientToItsRate) {
  constexpr std::uint64_t kRate = 4000;  // bytes per second
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    make({.region = {2, 2, 2}, .limits = {.max_bytes_per_second = kRate}});
    ClientOptions options;
    options.delivery = delivery;
    options.budget.bytes = 1 << 20;  // Whatever it asks for.
    Client client = make_client(options);
    const ConnectionId connection = join(client);
    const double begin = now_;
    std::uint64_t received = 0, least = UINT64_MAX, before = 0;
    for (int i = 0; i < 200; ++i) {
      update();
      exchange(connection, client);
      received = client.statistics().bytes;
      // A burst of a second, and one message that began within the credit.
      EXPECT_LE(static_cast<double>(received), kRate * (now_ - begin + 1) + 16000);
      if (i % 50 != 49) continue;
      least = std::min(least, received - before);
      before = received;
    }
    // Paced: not all at first and nothing later. Five seconds each.
    EXPECT_GT(least, kRate * 5 / 2);
    // Regions are the same for all: who cannot afford one more waits.
    if (delivery == Delivery::shared) {
      EXPECT_GT(server_->statistics(connection)->skipped, 0U);
    }
    EXPECT_FALSE(dropped(connection).has_value());
    // When nothing changes any more, all of it comes.
    for (int i = 0; i < 100; ++i) {
      now_ += 0.1;
      ASSERT_EQ(server_->update(now_, now_), Status::ok);
      exchange(connection, client);
    }
    EXPECT_EQ(client.statistics().failed_proofs, 0U);
    EXPECT_TRUE(std::ranges::equal(client.frame().volumes[0].textures[0].texels,
                                   std::as_const(texture_).view().bytes));
  }
}

TEST_F(ServerTest, SaysWhatADroppedConnectionWasSent) {
  make();
  Client client = make_client();
  const ConnectionId connection = join(client);
  EXPECT_FALSE(server_->statistics(connect()).has_value());
  update();
  exchange(connection, client);
  const std::uint64_t bytes = client.statistics().bytes;
  server_->drop(connection, Reason::dismissed);
  EXPECT_EQ(dropped(connection), Reason::dismissed);
  ASSERT_TRUE(server_->statistics(connection).has_value());
  EXPECT_EQ(server_->statistics(connection)->bytes, bytes);
  EXPECT_EQ(server_->statistics(connection)->updates, 1U);
  server_->disconnect(connection, now_);
  EXPECT_FALSE(server_->statistics(connection).has_value());
}

/// With times that are none the session goes on as before.
TEST_F(ServerTest, TookWhatIsNoTime) {
  make();
  Client client = make_client();
  const ConnectionId connection = join(client);
  server_->report_update_time(1, 0.1);  // Too long: from here on there is a limit.
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(),
                   kInfinity = std::numeric_limits<double>::infinity();
  for (const auto& [seconds, most] :
       {std::pair(kNaN, 0.1), std::pair(0.01, kNaN), std::pair(kInfinity, 0.1),
        std::pair(0.01, kInfinity), std::pair(-1.0, 0.1), std::pair(0.01, 0.0),
        std::pair(0.01, -1.0), std::pair(0.0, 0.1)}) {
    server_->report_update_time(seconds, most);
    expect_others_go_on(connection, client);
  }
}

}  // namespace
}  // namespace gicodec
