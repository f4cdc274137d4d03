// As many hostile clients as a server takes, from four addresses, each doing its worst, and an
// honest client among them. In virtual time: the path is modelled, and so is the processor, which
// takes its time for every block that is written into a packet.
#include "../messages.h"
#include "path_to_server.h"

#include <cstdio>
#include <map>

namespace gicodec {
namespace {

using namespace test;

constexpr std::uint32_t kMaxClients = 64;
constexpr int kAddresses = 4, kPerAddress = 12;

enum class AttackKind : std::uint8_t {
  own_flood,  ///< packets of its own, everything, as fast as it can
  half_open,  ///< connects and says nothing
  resyncs,    ///< claims to have lost everything
  slow,       ///< takes and never acknowledges
  garbage,    ///< says what is no message
  replays,    ///< says again what it said before
  flips,      ///< another half of the blocks at every update
  late,       ///< acknowledges now and then, so that it holds what nobody else does
};
constexpr int kKinds = 8;

struct Hostile {
  AttackKind kind{};
  int address = 0;
  ConnectionId connection = 0;  ///< 0: not connected
  double again = 0;             ///< when it connects again
  std::uint32_t sync = 1;
  std::uint32_t update_sync = 0, number = 0;  ///< of the last update that it got
  bool welcome = false;
  int turn = 0;
  std::vector<Message> said;
};

class Attack : public PathToServer {
 public:
  explicit Attack(double rate) : PathToServer(rate, options(), kMaxClients) {}

  /// One for each of max_clients, in turn from each address.
  void attack() {
    for (std::uint32_t i = 0; i < kMaxClients; ++i) {
      Hostile& one = hostile_.emplace_back();
      one.kind = static_cast<AttackKind>(i % kKinds);
      one.address = static_cast<int>(i / kKinds) % kAddresses;
      flow_of_[&one] = add_flow(0.01);
    }
  }
  std::map<Reason, int> dropped;
  std::size_t most_memory = 0, most_unsent = 0;
  std::uint64_t most_written = 0;

 protected:
  /// As gi-server's defaults.
  static ServerOptions options() {
    ServerOptions options;
    options.limits.max_waiting = 48;
    options.limits.max_connections = kMaxClients + 48 + 16;
    options.proofs = true;
    return options;
  }

  void after_update() override {
    constexpr double kSecondsPerBlock = 8e-6;
    const std::uint64_t written = server().written().all;
    most_written = std::max(most_written, written);
    const double took = kSecondsPerBlock * static_cast<double>(written);
    advance(took);
    server().report_update_time(took, kInterval);
    for (const ServerEvent& event : server().take_events()) {
      if (event.type != ServerEvent::Type::dropped) continue;
      ++dropped[event.reason];
      for (Hostile& one : hostile_) {
        if (one.connection == event.connection) leave(one);
      }
    }
    most_memory = std::max(most_memory, server().memory());
    most_unsent = std::max(most_unsent, unsent());
  }

  void tick() override {
    for (Hostile& one : hostile_) {
      if (one.connection == 0) {
        if (now() >= one.again) come(one);
      } else {
        act(one);
      }
    }
  }

 private:
  void come(Hostile& one) {
    one.again = now() + 0.1;
    if (connections_[one.address] >= kPerAddress) return;
    const auto connection = server().connect(now());
    if (!connection.ok()) return;
    ++connections_[one.address];
    one.connection = *connection;
    one.welcome = false;
    one.sync = 1;
    one.update_sync = one.number = 0;
    if (one.kind == AttackKind::half_open) return;
    if (one.kind == AttackKind::replays && !one.said.empty()) {
      for (const Message& message : one.said) server().receive(one.connection, message, now());
      return;
    }
    const bool own = one.kind == AttackKind::own_flood || one.kind == AttackKind::resyncs;
    say(one, Hello{one.sync, {}, own ? Delivery::unicast : Delivery::shared});
    say(one, Subscribe{1, 0, 0, BlockMask(kBlocks, 1)});
  }

  void leave(Hostile& one) {
    server().disconnect(one.connection, now());
    --connections_[one.address];
    one.connection = 0;
    flow(flow_of_[&one]).waiting.clear();
    flow(flow_of_[&one]).down.clear();
  }

  void say(Hostile& one, const AnyMessage& message) {
    Message bytes;
    ASSERT_EQ(write_message(message, bytes), Status::ok);
    server().receive(one.connection, bytes, now());
    one.said.push_back(std::move(bytes));
    if (one.said.size() > 40) one.said.erase(one.said.begin() + 20);
  }

  void act(Hostile& one) {
    Flow& way = flow(flow_of_[&one]);
    for (Message& message : joined(server().take_messages(one.connection)))
      send(way, std::move(message));
    ++one.turn;
    while (const auto message = arrived(way.down, now())) {
      const auto read = read_message(*message);
      if (const auto* update = read.ok() ? std::get_if<UpdateMessage>(&*read) : nullptr) {
        one.update_sync = update->sync;
        one.number = update->number;
        if (one.kind == AttackKind::own_flood || one.kind == AttackKind::flips ||
            one.kind == AttackKind::resyncs) {
          say(one, Acknowledge{one.update_sync, one.number});
        }
        if (one.kind == AttackKind::flips) flip(one);
      }
    }
    const auto every = [&](int ticks) { return one.turn % ticks == 0; };
    if (one.kind == AttackKind::resyncs && every(50)) say(one, Resync{++one.sync, 1, {}});
    if (one.kind == AttackKind::garbage && every(10)) {
      Message garbage(pick(random_, 1, 2000));
      for (auto& byte : garbage) byte = static_cast<std::byte>(random_());
      server().receive(one.connection, garbage, now());
    }
    if (one.kind == AttackKind::replays && every(20) && !one.said.empty()) {
      server().receive(one.connection, one.said[one.turn / 20 % one.said.size()], now());
    }
    if (one.kind == AttackKind::late && one.number > 0 && chance(random_, 100)) {
      say(one, Acknowledge{one.update_sync, one.number});
    }
  }

  void flip(Hostile& one) {
    BlockMask half(kBlocks);
    for (std::uint32_t i = 0; i < kBlocks; ++i) half[i] = ((i ^ one.number) & 1) != 0 && i % 7 != 0;
    if ((one.number & 2) != 0) std::fill(half.begin(), half.begin() + kBlocks / 2, 0);
    say(one, Subscribe{1, 0, 0, half});
  }

  Random random_{77};
  std::deque<Hostile> hostile_;
  std::map<const Hostile*, std::size_t> flow_of_;
  std::map<int, int> connections_;
};

/// Beside 64 of them an honest client joins within two seconds and keeps four fifths of its
/// updates; nobody ends the server, and what it holds stays within a bound.
TEST(Attacks, LeaveHonestClientsTheirUpdates) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    Attack attack(40 * PathToServer::demand());
    attack.attack();
    attack.run(3);
    attack.join(1, delivery, 0.01, 1e18, false);
    attack.begin();
    attack.run(2);
    const Measured joining = attack.measured(2, 0, 1);
    EXPECT_GT(joining.filled, 0U);
    attack.begin();
    attack.run(10);
    const Measured m = attack.measured(10, 0, 1);
    std::printf(
        "%llu updates with contents of 100, %.2f MB/s, latency %.0f, 95 %% %.0f ms; memory %.1f "
        "MB, "
        "unsent %.1f MB, most blocks in an update %llu; dropped",
        static_cast<unsigned long long>(m.filled), m.goodput * 1e-6, m.typical * 1e3, m.late * 1e3,
        static_cast<double>(attack.most_memory) * 1e-6,
        static_cast<double>(attack.most_unsent) * 1e-6,
        static_cast<unsigned long long>(attack.most_written));
    for (const auto& [reason, count] : attack.dropped) {
      std::printf(" %s %d,", std::string(to_string(reason)).c_str(), count);
    }
    std::printf("\n");
    EXPECT_GE(m.filled, 80U);
    // docs/guarantees.md, "Servers".
    const std::size_t content =
        PathToServer::kBlocks * block_bytes(ddgi_irradiance(PathToServer::kGrid));
    EXPECT_LT(attack.most_memory,
              2 * (48 + 48) * content + kMaxClients * 300 * std::size_t{PathToServer::kBlocks});
    EXPECT_LT(attack.most_unsent, kMaxClients * 3 * content);
    EXPECT_EQ(m.dropped + m.gaps + m.failed_proofs, 0U);
    EXPECT_FALSE(attack.dropped.empty());
  }
}

}  // namespace
}  // namespace gicodec
