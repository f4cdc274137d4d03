// A server and its clients over a network that delays, loses, repeats and reorders, with random
// schedules of change, scrolling, views, budgets, lost connections and returns. The server sends a
// hash of what it believes each client to hold with every update, and what some of them record
// plays as what they hold; once the network is kind and nothing changes, clients hold what was
// published.
#include "../messages.h"
#include "session/any_volume.h"
#include "session/recording_check.h"

#include <gicodec/client.h>
#include <gicodec/server.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <optional>

namespace gicodec {
namespace {

using namespace test;

constexpr double kStep = 0.1;  ///< seconds between updates

/// What a network does to messages.
struct Weather {
  bool ordered = true;
  std::uint32_t lost_one_in = 0, repeated_one_in = 0, damaged_one_in = 0;
  double delay = 0, jitter = 0;
};

/// Flips a bit of a packet in an update.
void damage(Message& message, Random& random) {
  const auto read = read_message(message);
  const auto* const update = read.ok() ? std::get_if<UpdateMessage>(&*read) : nullptr;
  if (update == nullptr || update->parts.empty()) return;
  const auto packet = update->parts.front().packet;
  const auto offset = static_cast<std::size_t>(packet.data() - message.data());
  const auto at = pick(random, 0, static_cast<std::uint32_t>(packet.size() - 1));
  message[offset + at] ^= static_cast<std::byte>(1U << pick(random, 0, 7));
}

/// Messages in one direction.
class Link {
 public:
  void send(Message message, double now, const Weather& weather, Random& random) {
    const auto happens = [&](std::uint32_t one_in) {
      return one_in != 0 && chance(random, one_in);
    };
    if (happens(weather.lost_one_in)) return;
    if (happens(weather.damaged_one_in)) damage(message, random);
    const int copies = happens(weather.repeated_one_in) ? 2 : 1;
    for (int i = 0; i < copies; ++i) {
      double at = now + weather.delay + weather.jitter * pick(random, 0, 100) / 100.0;
      if (weather.ordered && !waiting_.empty()) at = std::max(at, waiting_.rbegin()->first);
      waiting_.emplace(at, message);
    }
  }
  std::optional<Message> receive(double now) {
    if (waiting_.empty() || waiting_.begin()->first > now) return std::nullopt;
    Message message = std::move(waiting_.begin()->second);
    waiting_.erase(waiting_.begin());
    return message;
  }
  void clear() { waiting_.clear(); }

 private:
  std::multimap<double, Message> waiting_;
};

/// A client, its connection if it has one, and what it asked for.
struct Player {
  RecordingCheck recording{{&kAny}};  ///< plays what it records; outlives the client
  std::optional<Client> client;
  Delivery delivery = Delivery::unicast;
  bool limited = false;
  ConnectionId connection = 0;
  double hello_at = 0;
  Link up, down;
  std::vector<std::vector<BlockMask>> visible;  ///< by volume and group
};

class SimulatedWorld {
 public:
  SimulatedWorld(Random& random, const char* backend) : random_(random) {
    ServerOptions options;
    options.backend = backend;
    options.threads = pick(random, 1, 2);
    options.settings.isa = any_isa(random);
    options.region = {pick(random, 1, 4), pick(random, 1, 4), pick(random, 1, 4)};
    options.kinds = {&kAny};
    options.proofs = true;
    options.limits.messages_per_second = 1000;
    options.limits.max_in_flight = pick(random, 2, 20);
    options.timeouts.linger = chance(random, 3) ? 0.3 : 10;
    if (chance(random, 3)) options.limits.max_bytes_per_second = pick(random, 2000, 20000);
    options.timeouts.stall = 5;
    options.timeouts.hello = 5;
    auto server = Server::create(options);
    EXPECT_TRUE(server.ok());
    server_.emplace(*std::move(server));
    for (std::uint32_t v = 0, volumes = pick(random, 1, 2); v < volumes; ++v) add_volume();
  }

  void join() {
    auto player = std::make_unique<Player>();
    player->delivery = chance(random_, 2) ? Delivery::shared : Delivery::unicast;
    ClientOptions options;
    options.delivery = player->delivery;
    options.isa = any_isa(random_);
    options.kinds = {&kAny};
    if (player->delivery == Delivery::unicast && chance(random_, 2)) {
      player->limited = true;
      options.budget.blocks = pick(random_, 1, 40);
    }
    if (chance(random_, 2)) options.listener = &player->recording;
    auto client = Client::create(options);
    ASSERT_TRUE(client.ok());
    player->client.emplace(*std::move(client));
    for (std::uint16_t v = 0; v < volumes_.size(); ++v) show(*player, v, 0);
    players_.push_back(std::move(player));
  }

  void step(bool still) {
    now_ += kStep;
    if (!still) {
      change();
      for (const auto& player : players_) disturb(*player);
      if (chance(random_, 12)) weather_ = any_weather();
    }
    for (const auto& player : players_) {
      if (player->connection == 0) connect(*player);
    }
    ASSERT_EQ(server_->update(now_, now_), Status::ok);
    // Several rounds between updates, so that short delays allow an answer in time.
    for (int round = 0; round < 4; ++round) {
      now_ += kStep / 8;
      for (const auto& player : players_) exchange(*player);
    }
    static_cast<void>(server_->take_events());
    for (const auto& player : players_) {
      ASSERT_EQ(player->client->statistics().failed_proofs, 0U);
    }
  }

  /// Everything arrives when the network is kind and nothing changes.
  void settle() {
    weather_ = {};
    std::uint32_t steps = 80;  // A request that was lost costs the connection after a timeout.
    for (const auto& volume : volumes_) {
      if (volume == nullptr) continue;
      for (std::size_t group = 0; group < volume->desc().groups.size(); ++group) {
        const auto textures = volume->desc().groups[group].textures.size();
        steps += 4 * volume->blocks(group) *
                 static_cast<std::uint32_t>(std::max<std::size_t>(textures, 2));
      }
    }
    const auto settled = [&] {
      return std::ranges::all_of(players_, [&](const auto& player) {
        return player->client->consistent() && missing(*player) == 0;
      });
    };
    for (std::uint32_t i = 0; i < steps && !testing::Test::HasFailure(); ++i) {
      step(true);
      if (i >= 8 && settled()) break;
    }
    for (const auto& player : players_) {
      EXPECT_TRUE(player->client->consistent());
      EXPECT_EQ(missing(*player), 0U);
      EXPECT_EQ(player->client->statistics().failed_proofs, 0U);
      proofs += player->client->statistics().proofs;
      player->recording.finish();
      recorded += player->recording.compared;
    }
  }

  std::uint64_t proofs = 0, recorded = 0;

 private:
  void add_volume() {
    auto volume = std::make_unique<AnyVolume>(random_);
    const auto id =
        server_->add_volume("volume", volume->desc(), volume->geometry(), volume->streamed());
    ASSERT_EQ(id.status(), Status::ok);
    volumes_.resize(std::max<std::size_t>(volumes_.size(), *id + 1U));
    ASSERT_EQ(volumes_[*id], nullptr);
    volumes_[*id] = std::move(volume);
    ++generation_;
    for (const auto& player : players_) show(*player, *id, 1);  // Until it is told otherwise.
  }

  void remove_volume() {
    const std::uint16_t v = any_volume();
    ASSERT_EQ(server_->remove_volume(v), Status::ok);
    volumes_[v].reset();
    ++generation_;
    for (const auto& player : players_) show(*player, v, 0);
  }

  /// What a player sees of all of a volume.
  void show(Player& player, std::uint16_t v, std::uint8_t visible) {
    player.visible.resize(std::max<std::size_t>(player.visible.size(), v + 1U));
    player.visible[v].clear();
    if (volumes_[v] == nullptr) return;
    for (std::size_t group = 0; group < volumes_[v]->desc().groups.size(); ++group) {
      player.visible[v].emplace_back(volumes_[v]->blocks(group), visible);
    }
  }

  [[nodiscard]] std::uint16_t any_volume() {
    const auto last = static_cast<std::uint32_t>(volumes_.size() - 1);
    auto v = static_cast<std::uint16_t>(pick(random_, 0, last));
    while (volumes_[v] == nullptr) v = static_cast<std::uint16_t>((v + 1U) % volumes_.size());
    return v;
  }

  Weather any_weather() {
    Weather weather;
    weather.ordered = chance(random_, 2);
    if (!weather.ordered) {
      weather.lost_one_in = chance(random_, 2) ? pick(random_, 3, 30) : 0;
      weather.repeated_one_in = chance(random_, 2) ? pick(random_, 3, 30) : 0;
      weather.damaged_one_in = chance(random_, 3) ? pick(random_, 5, 50) : 0;
    }
    weather.delay = chance(random_, 2) ? pick(random_, 0, 50) / 100.0 : 0;
    weather.jitter = chance(random_, 2) ? pick(random_, 0, 30) / 100.0 : 0;
    return weather;
  }

  void change() {
    if (chance(random_, 12) && server_->volumes() < 3) add_volume();
    if (chance(random_, 16) && server_->volumes() > 1) remove_volume();
    for (std::uint16_t v = 0; v < volumes_.size(); ++v) {
      if (volumes_[v] == nullptr) continue;
      AnyVolume& volume = *volumes_[v];
      if (chance(random_, 5)) {
        ASSERT_EQ(server_->scroll(v, volume.scroll(random_)), Status::ok);
      }
      volume.change(random_, [&](std::uint8_t texture, ConstTextureView view) {
        return server_->publish(v, texture, view);
      });
    }
  }

  void connect(Player& player) {
    player.up.clear();
    player.down.clear();
    const auto connection = server_->connect(now_);
    ASSERT_TRUE(connection.ok());
    player.connection = *connection;
    player.hello_at = now_;
    const auto hello = player.client->hello();
    ASSERT_TRUE(hello.ok());
    // The first message must arrive first.
    player.up.send(*hello, now_, {}, random_);
  }

  void lose(Player& player) {
    server_->disconnect(player.connection, now_);
    player.connection = 0;
  }

  void disturb(Player& player) {
    if (player.connection == 0) return;
    if (chance(random_, 15)) return lose(player);
    if (player.client->is_connected() && chance(random_, 4)) look(player);
  }

  void look(Player& player) {
    const std::uint16_t v = any_volume();
    for (std::size_t group = 0; group < player.visible[v].size(); ++group) {
      BlockMask& mask = player.visible[v][group];
      std::ranges::fill(mask, std::uint8_t{0});
      for (const auto block : random_selection(random_, volumes_[v]->blocks(group)))
        mask[block] = 1;
    }
    tell(player, v);
  }

  /// Over a path that loses nothing, since nobody repeats it.
  void tell(Player& player, std::uint16_t v) {
    for (std::uint8_t group = 0; group < player.visible[v].size(); ++group) {
      Message message;
      ASSERT_EQ(write_message(Subscribe{generation_, v, group, player.visible[v][group]}, message),
                Status::ok);
      if (const auto client = server_->client(player.connection)) {
        server_->receive(player.connection, message, now_);
      }
    }
  }

  void exchange(Player& player) {
    if (player.connection == 0) return;
    while (const auto message = player.up.receive(now_))
      server_->receive(player.connection, *message, now_);
    for (Message& message : joined(server_->take_messages(player.connection))) {
      player.down.send(std::move(message), now_, weather_, random_);
    }
    const bool welcome = player.client->is_connected();
    while (const auto message = player.down.receive(now_)) {
      // A Goodbye; what goes on is another connection.
      if (player.client->receive(*message) != Status::ok) return lose(player);
    }
    for (Message& reply : player.client->take_messages()) {
      Weather up = weather_;
      up.ordered = true;
      up.damaged_one_in = 0;
      player.up.send(std::move(reply), now_, up, random_);
    }
    if (!welcome && player.client->is_connected() && !player.client->resumed()) {
      for (std::uint16_t v = 0; v < volumes_.size(); ++v) tell(player, v);
    }
    if (!player.client->is_connected() && now_ - player.hello_at > 2) lose(player);
  }

  /// Visible blocks that the client does not hold as they were published.
  [[nodiscard]] std::uint32_t missing(const Player& player) const {
    std::uint32_t count = 0;
    const ClientFrame& frame = player.client->frame();
    if (frame.volumes.size() != server_->volumes()) return 1;
    for (std::uint16_t v = 0; v < volumes_.size(); ++v) {
      if (volumes_[v] == nullptr) continue;
      const ClientVolume* const found = frame.find(v);
      if (found == nullptr || !same_but_layout(found->desc, volumes_[v]->desc())) return 1;
      const ClientVolume& volume = *found;
      if (!(volume.geometry == volumes_[v]->geometry())) ++count;
      const std::vector<BlockMask> active(player.visible[v].size());
      count +=
          volumes_[v]->missing(player.visible[v], active,
                               [&](std::uint8_t id, std::uint32_t block) -> std::optional<Bytes> {
                                 const ClientTexture& texture = volume.textures[id];
                                 if (texture.changed[block] == 0) return std::nullopt;
                                 return block_of(texture.desc, texture.texels, block);
                               });
    }
    return count;
  }

  Random& random_;
  double now_ = 0;
  Weather weather_;
  std::optional<Server> server_;
  std::vector<std::unique_ptr<AnyVolume>> volumes_;  ///< by number; null if it was removed
  std::uint32_t generation_ = 0;
  std::vector<std::unique_ptr<Player>> players_;
};

/// How many states were compared, with the server's and with what was recorded.
struct Compared {
  std::uint64_t proofs = 0, recorded = 0;
};
Compared run_simulated_world(std::uint64_t seed, const char* backend) {
  SCOPED_TRACE(seed);
  Random random(seed);
  SimulatedWorld world(random, backend);
  for (std::uint32_t i = 0, players = pick(random, 1, 4); i < players; ++i) world.join();
  const int steps = static_cast<int>(pick(random, 5, 40));
  for (int step = 0; step < steps && !testing::Test::HasFailure(); ++step) {
    world.step(false);
    if (chance(random, 20)) world.join();
  }
  if (!testing::Test::HasFailure()) world.settle();
  return {world.proofs, world.recorded};
}

RC_GTEST_PROP(SessionSimulation, StatesAgreeOverAnyNetwork, (std::uint64_t seed)) {
  run_simulated_world(seed, "raw");
  RC_ASSERT(!testing::Test::HasFailure());
}

RC_GTEST_PROP(SessionSimulation, WithTheNativeCodec, (std::uint64_t seed)) {
  run_simulated_world(seed, "native");
  RC_ASSERT(!testing::Test::HasFailure());
}

/// The same schedules every time; shards, so that they run side by side.
class ManySchedules : public testing::TestWithParam<std::uint64_t> {};

TEST_P(ManySchedules, StatesAgree) {
  const std::uint64_t schedules = everything() ? 500 : 300 / one_case_in();
  Compared all;
  for (std::uint64_t i = 0; i < schedules && !testing::Test::HasFailure(); ++i) {
    const Compared one = run_simulated_world(GetParam() * schedules + i, "raw");
    all.proofs += one.proofs;
    all.recorded += one.recorded;
  }
  EXPECT_GT(all.proofs, 20 * schedules);
  EXPECT_GT(all.recorded, 20 * schedules);
}

INSTANTIATE_TEST_SUITE_P(Shards, ManySchedules, testing::Range<std::uint64_t>(0, 6));

}  // namespace
}  // namespace gicodec
