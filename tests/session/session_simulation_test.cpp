// A host and its clients over a network that delays, loses, repeats and reorders, with random
// schedules of change, scrolling, views, budgets, lost connections and returns. The server sends a
// hash of what it believes each client to hold with every update; once the network is kind and
// nothing changes, clients hold what was published.
#include "support.h"

#include <gicodec/client.h>
#include <gicodec/host.h>

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
  std::optional<Client> client;
  Delivery delivery = Delivery::own;
  bool limited = false;
  PeerId peer = 0;
  double hello_at = 0;
  Link up, down;
  std::vector<ProbeMask> visible;
};

class World {
 public:
  World(Random& random, const char* backend) : random_(random) {
    ServerOptions options;
    options.backend = backend;
    options.threads = pick(random, 1, 2);
    options.settings.isa = any_isa(random);
    options.chunk = {pick(random, 1, 4), pick(random, 1, 4), pick(random, 1, 4)};
    options.max_unacknowledged = pick(random, 0, 40);
    HostOptions host_options;
    host_options.proofs = true;
    host_options.messages_per_second = 1000;
    host_options.max_in_flight = pick(random, 2, 20);
    host_options.linger = chance(random, 3) ? 0.3 : 10;
    if (chance(random, 3)) host_options.max_bytes_per_second = pick(random, 2000, 20000);
    host_options.stall_timeout = 5;
    host_options.hello_timeout = 5;
    auto server = Server::create(options);
    EXPECT_TRUE(server.ok());
    auto host = Host::create(*std::move(server), host_options);
    EXPECT_TRUE(host.ok());
    host_.emplace(*std::move(host));
    for (std::uint32_t v = 0, volumes = pick(random, 1, 2); v < volumes; ++v) add_volume();
  }

  void join() {
    auto player = std::make_unique<Player>();
    player->delivery = chance(random_, 2) ? Delivery::shared : Delivery::own;
    ClientOptions options;
    options.delivery = player->delivery;
    options.isa = any_isa(random_);
    if (player->delivery == Delivery::own && chance(random_, 2)) {
      player->limited = true;
      options.budget.probes = pick(random_, 1, 40);
    }
    auto client = Client::create(options);
    ASSERT_TRUE(client.ok());
    player->client.emplace(*std::move(client));
    for (const auto& volume : volumes_) player->visible.emplace_back(volume.probes(), 0);
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
      if (player->peer == 0) connect(*player);
    }
    ASSERT_EQ(host_->update(now_, now_), Status::ok);
    // Several rounds between updates, so that short delays allow an answer in time.
    for (int round = 0; round < 4; ++round) {
      now_ += kStep / 8;
      for (const auto& player : players_) exchange(*player);
    }
    static_cast<void>(host_->take_events());
    for (const auto& player : players_) {
      ASSERT_EQ(player->client->statistics().failed_proofs, 0U);
    }
  }

  /// Everything arrives when the network is kind and nothing changes.
  void settle() {
    weather_ = {};
    std::uint32_t steps = 80;  // A request that was lost costs the connection after a timeout.
    for (const auto& volume : volumes_) steps += 8 * volume.probes();
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
    }
  }

  std::uint64_t proofs = 0;

 private:
  struct Volume {
    VolumeGeometry geometry;
    std::vector<std::unique_ptr<Texture>> textures;
    [[nodiscard]] std::uint32_t probes() const {
      return geometry.grid.x * geometry.grid.y * geometry.grid.z;
    }
  };

  void add_volume() {
    Volume volume;
    volume.geometry.grid = {pick(random_, 1, 5), pick(random_, 1, 4), pick(random_, 1, 5)};
    std::vector<StreamedTexture> textures;
    for (int i = 0; i < 2; ++i) {
      TextureDesc desc = random_desc(random_, 1000);
      desc.grid = volume.geometry.grid;
      desc.core = static_cast<std::uint16_t>(pick(random_, 1, 4));
      textures.push_back({desc, pick(random_, 1, 2), 0});
      volume.textures.push_back(std::make_unique<Texture>(desc));
    }
    const std::vector<std::string> names{"first", "second"};
    const auto id = host_->add_volume("volume", volume.geometry, textures, names);
    ASSERT_TRUE(id.ok());
    volumes_.push_back(std::move(volume));
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
    for (std::uint16_t v = 0; v < volumes_.size(); ++v) {
      Volume& volume = volumes_[v];
      std::vector<std::uint32_t> entered;
      if (chance(random_, 5)) {
        const Scroll before = volume.geometry.scroll;
        for (auto& cells : volume.geometry.scroll) {
          cells += static_cast<std::int32_t>(pick(random_, 0, 4)) - 2;
        }
        ASSERT_EQ(host_->scroll(v, volume.geometry.scroll), Status::ok);
        entered = entering_probes(volume.geometry.grid, before, volume.geometry.scroll);
      }
      for (std::uint8_t t = 0; t < volume.textures.size(); ++t) {
        if (entered.empty() && chance(random_, 4)) continue;
        Texture& texture = *volume.textures[t];
        auto probes = random_selection(random_, volume.probes());
        probes.insert(probes.end(), entered.begin(), entered.end());
        for (const auto probe : probes) {
          texture.fill_core(probe, chance(random_, 4) ? Fill::zero : Fill::noise, random_);
          if (!chance(random_, 4)) texture.fill_border(probe);
        }
        ASSERT_EQ(host_->server().publish(v, t, std::as_const(texture).view()), Status::ok);
      }
    }
  }

  void connect(Player& player) {
    player.up.clear();
    player.down.clear();
    const auto peer = host_->connect(now_);
    ASSERT_TRUE(peer.ok());
    player.peer = *peer;
    player.hello_at = now_;
    const auto hello = player.client->hello();
    ASSERT_TRUE(hello.ok());
    // The first message must arrive first.
    player.up.send(*hello, now_, {}, random_);
  }

  void lose(Player& player) {
    host_->disconnect(player.peer, now_);
    player.peer = 0;
  }

  void disturb(Player& player) {
    if (player.peer == 0) return;
    if (chance(random_, 15)) return lose(player);
    if (player.client->welcome() && chance(random_, 4)) look(player);
  }

  void look(Player& player) {
    const auto v = static_cast<std::uint16_t>(
        pick(random_, 0, static_cast<std::uint32_t>(volumes_.size() - 1)));
    std::ranges::fill(player.visible[v], std::uint8_t{0});
    for (const auto probe : random_selection(random_, volumes_[v].probes())) {
      player.visible[v][probe] = 1;
    }
    tell(player, v);
  }

  /// Over a path that loses nothing, since nobody repeats it.
  void tell(Player& player, std::uint16_t v) {
    Message message;
    ASSERT_EQ(write_message(Subscribe{v, player.visible[v]}, message), Status::ok);
    if (const auto client = host_->client(player.peer)) {
      host_->receive(player.peer, message, now_);
    }
  }

  void exchange(Player& player) {
    if (player.peer == 0) return;
    while (const auto message = player.up.receive(now_))
      host_->receive(player.peer, *message, now_);
    for (Message& message : host_->take_messages(player.peer)) {
      player.down.send(std::move(message), now_, weather_, random_);
    }
    const bool welcome = player.client->welcome();
    while (const auto message = player.down.receive(now_)) {
      // A Goodbye; what goes on is another connection.
      if (player.client->receive(*message) != Status::ok) return lose(player);
    }
    for (Message& reply : player.client->take_replies()) {
      Weather up = weather_;
      up.ordered = true;
      up.damaged_one_in = 0;
      player.up.send(std::move(reply), now_, up, random_);
    }
    if (!welcome && player.client->welcome() && !player.client->resumed()) {
      for (std::uint16_t v = 0; v < volumes_.size(); ++v) tell(player, v);
    }
    if (!player.client->welcome() && now_ - player.hello_at > 2) lose(player);
  }

  /// Visible blocks that the client does not hold as they were published.
  [[nodiscard]] std::uint32_t missing(const Player& player) const {
    std::uint32_t count = 0;
    const ClientFrame& frame = player.client->frame();
    if (frame.volumes.size() != volumes_.size()) return 1;
    for (std::size_t v = 0; v < volumes_.size(); ++v) {
      if (!(frame.volumes[v].geometry == volumes_[v].geometry)) ++count;
      for (std::size_t t = 0; t < volumes_[v].textures.size(); ++t) {
        const Texture& truth = *volumes_[v].textures[t];
        const ClientTexture& held = frame.volumes[v].textures[t];
        Texture copy(held.desc);
        std::ranges::copy(held.texels, copy.view().bytes.begin());
        for (std::uint32_t probe = 0; probe < volumes_[v].probes(); ++probe) {
          if (player.visible[v][probe] != 0) count += copy.block(probe) != truth.block(probe);
        }
      }
    }
    return count;
  }

  Random& random_;
  double now_ = 0;
  Weather weather_;
  std::optional<Host> host_;
  std::vector<Volume> volumes_;
  std::vector<std::unique_ptr<Player>> players_;
};

/// Returns how many states were compared.
std::uint64_t run_world(std::uint64_t seed, const char* backend) {
  SCOPED_TRACE(seed);
  Random random(seed);
  World world(random, backend);
  for (std::uint32_t i = 0, players = pick(random, 1, 4); i < players; ++i) world.join();
  const int steps = static_cast<int>(pick(random, 5, 40));
  for (int step = 0; step < steps && !testing::Test::HasFailure(); ++step) {
    world.step(false);
    if (chance(random, 20)) world.join();
  }
  if (!testing::Test::HasFailure()) world.settle();
  return world.proofs;
}

RC_GTEST_PROP(SessionSimulation, StatesAgreeOverAnyNetwork, (std::uint64_t seed)) {
  run_world(seed, "raw");
  RC_ASSERT(!testing::Test::HasFailure());
}

RC_GTEST_PROP(SessionSimulation, WithTheNativeCodec, (std::uint64_t seed)) {
  run_world(seed, "native");
  RC_ASSERT(!testing::Test::HasFailure());
}

/// The same schedules every time; shards, so that they run side by side.
class ManySchedules : public testing::TestWithParam<std::uint64_t> {};

TEST_P(ManySchedules, StatesAgree) {
  const std::uint64_t schedules = everything() ? 500 : 100;
  std::uint64_t proofs = 0;
  for (std::uint64_t i = 0; i < schedules && !testing::Test::HasFailure(); ++i) {
    proofs += run_world(GetParam() * schedules + i, "raw");
  }
  EXPECT_GT(proofs, 20 * schedules);
}

INSTANTIATE_TEST_SUITE_P(Shards, ManySchedules, testing::Range<std::uint64_t>(0, 6));

}  // namespace
}  // namespace gicodec
