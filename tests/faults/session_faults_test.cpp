// Whatever allocation or thread fails in a call of a server or a client: the call says so
// or one client is gone, and in the end every client holds what was published, in a scene that does
// not change any more.
#include "../messages.h"
#include "faults.h"
#include "support.h"
#include "volumes.h"

#include <gicodec/client.h>
#include <gicodec/server.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

namespace gicodec {
namespace {

using namespace test;

constexpr Grid kGrid{3, 2, 2};
constexpr std::uint32_t kBlocks = 12;
const TextureDesc kColor = probe_texture(Format::R16_SFLOAT, kGrid, 2);
const VolumeDesc kVolume = probes_of({{"color", kColor}});

/// A client and its connection, if it has one.
struct Player {
  Delivery delivery = Delivery::unicast;
  std::optional<Client> client;
  ConnectionId connection = 0;
};

/// A session of three clients, in which every call of the library goes through a fault.
class World {
  template <typename Call>
  auto insist(Call&& call) {
    auto result = fault_(call);
    if (failed(result)) {
      EXPECT_TRUE(fault_.failed());
      result = call();
    }
    return result;
  }
  static bool failed(Status status) { return status != Status::ok; }
  template <typename T>
  static bool failed(const Result<T>& result) {
    return !result.ok();
  }

 public:
  World(Fault& fault, unsigned threads) : fault_(fault) {
    ServerOptions options;
    options.backend = "raw";
    options.region = {2, 2, 2};
    options.threads = threads;
    options.proofs = true;
    auto server = insist([&] { return Server::create(options); });
    EXPECT_TRUE(server.ok());
    server_.emplace(*std::move(server));
    EXPECT_TRUE(insist([&] { return server_->add_volume("volume", kVolume, {kGrid}); }).ok());
    texture_.fill(Fill::noise, random_);
  }

  void run() {
    join(Delivery::unicast);
    join(Delivery::shared);
    update();
    change({0, 5, 11});
    texture_.set_block(3, noise(random_, texture_.block(3).size()));  // A stale guard band.
    update();
    join(Delivery::shared);  // Gets snapshots.
    change({1, 2});
    update();
    scroll_ = {1, 0, 0};
    EXPECT_EQ(insist([&] { return server_->scroll(0, scroll_); }), Status::ok);
    change({0, 3, 6, 9, 10});
    update();
    lose_update_ = true;  // Both kinds ask for what is missing.
    change({4, 7});
    update();
    change({8});
    update();
    reconnect(players_.begin()->second);
    const std::vector<std::uint8_t> active(kBlocks, 1);
    EXPECT_EQ(insist([&] { return server_->set_active(0, active); }), Status::ok);
    change({5});
    update();
    update();
    fault_.end();  // And nothing changes any more.
    for (int i = 0; i < 3; ++i) update();
    for (auto& [id, player] : players_) {
      EXPECT_TRUE(player.client->consistent());
      EXPECT_EQ(player.client->statistics().failed_proofs, 0U);
      EXPECT_TRUE(std::ranges::equal(player.client->frame().volumes[0].textures[0].texels,
                                     std::as_const(texture_).view().bytes));
    }
  }

 private:
  void change(const std::vector<std::uint32_t>& blocks) {
    for (const std::uint32_t block : blocks) {
      texture_.fill_block(block, Fill::noise, random_);
      texture_.fill_band(block);
    }
  }

  void join(Delivery delivery) {
    Player& player = players_[++players_made_];
    player.delivery = delivery;
    ClientOptions options;
    options.delivery = delivery;
    auto client = insist([&] { return Client::create(options); });
    ASSERT_TRUE(client.ok());
    player.client.emplace(*std::move(client));
    connect(player);
  }

  void connect(Player& player) {
    const auto connection = insist([&] { return server_->connect(now_); });
    ASSERT_TRUE(connection.ok());
    player.connection = *connection;
    const auto hello = insist([&] { return player.client->hello(); });
    ASSERT_TRUE(hello.ok());
    tell(player, *hello);
    Message subscribe;
    ASSERT_EQ(write_message(Subscribe{1, 0, 0, BlockMask(kBlocks, 1)}, subscribe), Status::ok);
    tell(player, subscribe);
  }

  void reconnect(Player& player) {
    fault_([&] {
      server_->disconnect(player.connection, now_);
      return 0;
    });
    connect(player);
  }

  void tell(Player& player, const Message& message) {
    fault_([&] {
      server_->receive(player.connection, message, now_);
      return 0;
    });
  }

  void update() {
    now_ += 0.1;
    const auto view = std::as_const(texture_).view();
    EXPECT_EQ(insist([&] { return server_->publish(0, 0, view); }), Status::ok);
    const Status status = fault_([&] { return server_->update(now_, now_); });
    EXPECT_TRUE(status == Status::ok || fault_.failed());
    for (auto& [id, player] : players_) exchange(player);
    lose_update_ = false;
    // Told late if there was no memory for it.
    auto events = fault_([&] { return server_->take_events(); });
    for (const ServerEvent& event : server_->take_events()) events.push_back(event);
    for (const ServerEvent& event : events) {
      if (event.type != ServerEvent::Type::dropped || event.reason == Reason::replaced) continue;
      EXPECT_TRUE(fault_.failed());
      EXPECT_EQ(event.reason, Reason::exhausted);
      for (auto& [id, player] : players_) {
        if (player.connection == event.connection) reconnect(player);
      }
    }
  }

  void exchange(Player& player) {
    auto messages = joined(fault_([&] { return server_->take_messages(player.connection); }));
    if (lose_update_ && !messages.empty()) messages.pop_back();
    bool lost = false;
    for (const Message& message : messages) {
      const Status status = fault_([&] { return player.client->receive(message); });
      EXPECT_TRUE(status == Status::ok || fault_.failed());
      lost = lost || status != Status::ok;
      if (lost) break;
    }
    if (!lost) {
      const auto replies = fault_([&] { return player.client->take_messages(); });
      for (const Message& reply : replies) tell(player, reply);
      return;
    }
    // Who was dropped by the server is told by an event.
    if (player.client->goodbye().reason != Reason::exhausted) reconnect(player);
  }

  Fault& fault_;
  double now_ = 0;
  Random random_{1};
  Texture texture_{kColor};
  Scroll scroll_{};
  bool lose_update_ = false;
  std::optional<Server> server_;
  std::map<int, Player> players_;
  int players_made_ = 0;
};

TEST(SessionFaults, LeaveClientsRight) {
  const std::size_t faults = with_every_fault([](Fault& fault) { World(fault, 1).run(); });
  EXPECT_GT(faults, 500U);
}

TEST(SessionFaults, LeaveClientsOfThreadsRight) {
  const std::size_t faults = with_every_fault([](Fault& fault) { World(fault, 2).run(); });
  EXPECT_GT(faults, 500U);
}

/// A client on its own thread: an error is told, and after another hello() all is well.
TEST(SessionFaults, LeaveClientThreadsRight) {
  Random random(3);
  Texture texture(kColor);
  texture.fill(Fill::noise, random);
  const auto faults = with_every_fault([&](Fault& fault) {
    auto server = *Server::create({.backend = "raw"});
    ASSERT_TRUE(server.add_volume("volume", kVolume, {kGrid}).ok());
    auto client = *Client::create();
    auto thread = fault([&] { return ClientThread::start(std::move(client), {}); });
    if (!thread.ok()) thread = ClientThread::start(std::move(client), {});
    ASSERT_TRUE(thread.ok());
    for (int attempt = 0; attempt < 3; ++attempt) {
      const ConnectionId connection = *server.connect(0);
      const auto hello = fault([&] { return thread->hello(); });
      if (!hello.ok()) continue;
      server.receive(connection, *hello, 0);
      Message subscribe;
      ASSERT_EQ(write_message(Subscribe{1, 0, 0, BlockMask(kBlocks, 1)}, subscribe), Status::ok);
      server.receive(connection, subscribe, 0);
      ASSERT_EQ(server.publish(0, 0, std::as_const(texture).view()), Status::ok);
      ASSERT_EQ(server.update(0, 0), Status::ok);
      auto messages = joined(server.take_messages(connection));
      const Status status = fault([&] {
        Status first = Status::ok;
        for (Message& message : messages) {
          const Status pushed = thread->push(std::move(message));
          if (first == Status::ok) first = pushed;
        }
        while (!thread->idle()) continue;
        return first;
      });
      server.disconnect(connection, 0);
      if (status == Status::ok && thread->status() == Status::ok) break;
      ASSERT_TRUE(fault.failed());
    }
    ASSERT_EQ(thread->latest().volumes.size(), 1U);
    EXPECT_TRUE(std::ranges::equal(thread->latest().volumes[0].textures[0].texels,
                                   std::as_const(texture).view().bytes));
  });
  EXPECT_GT(faults, 20U);
}

}  // namespace
}  // namespace gicodec
