// A publisher of tracks, a broker that keeps some messages, and receivers that know neither, over
// networks that delay, lose, repeat, damage and reorder, from brokers that are behind. Receivers
// join late, change what they want, and see publishers change. Whenever a receiver has all, it
// shows what was published.
#include "session/any_volume.h"

#include <gicodec/client.h>
#include <gicodec/track_publisher.h>
#include <gicodec/track_receiver.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <optional>

namespace gicodec {
namespace {

using namespace test;

constexpr double kUpdateStep = 0.1;  ///< seconds between updates

/// What a broker keeps.
struct Kept {
  Message list, tick;
  std::map<std::pair<StreamId, std::uint32_t>, Message> objects;  ///< by stream and number

  void publish(const TrackMessage& message) {
    switch (message.type) {
      case TrackMessage::Type::list:
        list = message.bytes;
        break;
      case TrackMessage::Type::tick:
        tick = message.bytes;
        break;
      case TrackMessage::Type::object:
        objects[{message.stream, message.number}] = message.bytes;
    }
  }
};

struct Trouble {
  std::uint32_t lost_one_in = 0, repeated_one_in = 0, damaged_one_in = 0;
  std::uint32_t max_delay = 0;  ///< steps
  bool broker_lags = false;
};

struct Audience {
  std::optional<TrackReceiver> receiver;
  std::optional<Client> client;
  std::multimap<std::uint64_t, Message> waiting;  ///< by the step in which they arrive
  std::uint64_t chose = 0;                        ///< epoch of the last choice; 0: wants all
  std::vector<std::vector<BlockMask>> wanted;     ///< by volume and group; none: all
  std::uint64_t compared = 0;
};

class TrackWorld {
 public:
  explicit TrackWorld(Random& random) : random_(random) {
    region_ = {pick(random, 1, 4), pick(random, 1, 4), pick(random, 1, 4)};
    for (std::uint32_t v = 0, volumes = pick(random, 1, 2); v < volumes; ++v) {
      volumes_.push_back(std::make_unique<AnyVolume>(random));
    }
    begin_publishing();
  }

  void join() {
    auto one = std::make_unique<Audience>();
    auto receiver = TrackReceiver::create({.kinds = {&kAny}});
    ASSERT_TRUE(receiver.ok());
    one->receiver.emplace(*std::move(receiver));
    ClientOptions options;
    options.delivery = Delivery::shared;
    options.isa = any_isa(random_);
    options.kinds = {&kAny};
    auto client = Client::create(options);
    ASSERT_TRUE(client.ok());
    one->client.emplace(*std::move(client));
    const auto hello = one->client->hello();
    ASSERT_TRUE(hello.ok());
    ASSERT_EQ(one->receiver->take(*hello), Status::ok);
    audience_.push_back(std::move(one));
  }

  void step(bool still) {
    ++step_;
    if (!still) {
      if (chance(random_, 12)) trouble_ = any_trouble();
      if (chance(random_, 25)) begin_publishing();  // another epoch
      change();
    }
    const double now = static_cast<double>(step_) * kUpdateStep;
    ASSERT_EQ(publisher_->update(now, now), Status::ok);
    remember();
    for (const TrackMessage& message : publisher_->messages()) {
      kept_.publish(message);
      for (const auto& one : audience_) {
        const bool is_object = message.type == TrackMessage::Type::object;
        const auto wanted = one->receiver->wanted();
        const bool subscribed =
            message.number != 0 && std::ranges::find(wanted, message.stream) != wanted.end();
        if (!is_object || subscribed) send(*one, message.bytes);
      }
    }
    history_.push_back(kept_);
    if (history_.size() > 4) history_.pop_front();
    for (const auto& one : audience_) {
      if (!still && chance(random_, 10)) choose(*one);
      exchange(*one);
    }
  }

  /// Everything arrives when the network is kind and nothing changes.
  void settle() {
    trouble_ = {};
    const auto settled = [&] {
      return std::ranges::all_of(audience_, [](const auto& one) {
        return one->receiver->complete() && one->client->consistent();
      });
    };
    constexpr int kSteps = 200, kLimited = 150;
    for (int i = 0; i < kSteps && !testing::Test::HasFailure(); ++i) {
      step(true);
      if (i >= (limited_ ? kLimited : 8) && settled()) break;
    }
    EXPECT_TRUE(settled());
    // Who comes now has all at once.
    for (int i = 0; i < 4 && !testing::Test::HasFailure(); ++i) {
      if (chance(random_, 2)) change();
      step(true);
      step(true);
      join();
      for (int steps = 0; steps < 3; ++steps) step(true);
      EXPECT_TRUE(audience_.back()->receiver->complete());
      EXPECT_EQ(audience_.back()->client->frame().update, server_->updates());
    }
    for (const auto& one : audience_) {
      compare(*one);
      compared += one->compared;
      proofs += one->client->statistics().proofs;
    }
    statistics = publisher_->statistics();
  }

  std::uint64_t compared = 0, proofs = 0;
  TrackStatistics statistics;

 private:
  /// What was published, by texture and block.
  using State = std::vector<std::vector<std::vector<Bytes>>>;

  void begin_publishing() {
    publisher_.reset();
    ServerOptions options;
    options.backend = "raw";
    options.settings.isa = any_isa(random_);
    options.region = region_;
    options.kinds = {&kAny};
    options.proofs = true;
    options.epoch = ++epoch_;
    auto server = Server::create(options);
    ASSERT_TRUE(server.ok());
    server_.emplace(*std::move(server));
    for (auto& volume : volumes_) {
      // Each epoch has contents of its own.
      volume = std::make_unique<AnyVolume>(random_);
      ASSERT_TRUE(
          server_->add_volume("volume", volume->desc(), volume->geometry(), volume->streamed())
              .ok());
    }
    auto publisher = TrackPublisher::create(*server_, {.snapshot_seconds = 1});
    ASSERT_TRUE(publisher.ok());
    publisher_.emplace(*std::move(publisher));
    limited_ = chance(random_, 2);
    if (limited_) server_->set_limit_for_few(pick(random_, 1, 20));
    states_.clear();
    change();
  }

  Trouble any_trouble() {
    Trouble trouble;
    const auto maybe = [&](std::uint32_t from, std::uint32_t to) {
      return chance(random_, 2) ? pick(random_, from, to) : 0;
    };
    trouble.lost_one_in = maybe(3, 30);
    trouble.repeated_one_in = maybe(3, 30);
    trouble.damaged_one_in = maybe(5, 50);
    trouble.max_delay = maybe(1, 6);
    trouble.broker_lags = chance(random_, 2);
    return trouble;
  }

  void change() {
    for (std::uint16_t v = 0; v < volumes_.size(); ++v) {
      AnyVolume& volume = *volumes_[v];
      if (!states_.empty() && chance(random_, 5)) {
        ASSERT_EQ(server_->scroll(v, volume.scroll(random_)), Status::ok);
      }
      volume.change(random_, [&](std::uint8_t texture, ConstTextureView view) {
        return server_->publish(v, texture, view);
      });
    }
  }

  void remember() {
    State state;
    for (const auto& volume : volumes_) {
      volume->updated(server_->updates());
      auto& textures = state.emplace_back();
      std::uint8_t id = 0;
      for (std::size_t group = 0; group < volume->desc().groups.size(); ++group) {
        for (std::size_t t = 0; t < volume->desc().groups[group].textures.size(); ++t, ++id) {
          auto& blocks = textures.emplace_back();
          for (std::uint32_t b = 0; b < volume->blocks(group); ++b)
            blocks.push_back(volume->block(id, b, true));
        }
      }
    }
    states_[server_->updates()] = std::move(state);
  }

  void send(Audience& to, Message message) {
    const auto happens = [&](std::uint32_t one_in) {
      return one_in != 0 && chance(random_, one_in);
    };
    if (happens(trouble_.lost_one_in)) return;
    if (happens(trouble_.damaged_one_in))
      message.resize(pick(random_, 0, static_cast<std::uint32_t>(message.size() - 1)));
    const std::uint64_t at = step_ + pick(random_, 0, trouble_.max_delay);
    if (happens(trouble_.repeated_one_in)) to.waiting.emplace(at + 1, message);
    to.waiting.emplace(at, std::move(message));
  }

  void choose(Audience& one) {
    if (one.client->frame().volumes.size() != volumes_.size() || !one.client->is_connected() ||
        one.client->frame().epoch != epoch_)
      return;
    one.wanted.clear();
    one.chose = epoch_;
    for (std::uint16_t v = 0; v < volumes_.size(); ++v) {
      auto& masks = one.wanted.emplace_back();
      for (std::uint8_t group = 0; group < volumes_[v]->desc().groups.size(); ++group) {
        BlockMask& mask = masks.emplace_back(volumes_[v]->blocks(group), std::uint8_t{0});
        for (const auto block : random_selection(random_, volumes_[v]->blocks(group)))
          mask[block] = 1;
        ASSERT_EQ(one.client->subscribe(v, mask, group), Status::ok);
      }
    }
    reply(one);
  }

  static void reply(Audience& one) {
    for (const Message& said : one.client->take_messages())
      ASSERT_EQ(one.receiver->take(said), Status::ok);
  }

  void exchange(Audience& one) {
    while (!one.waiting.empty() && one.waiting.begin()->first <= step_) {
      ASSERT_TRUE(one.receiver->receive(one.waiting.begin()->second) == Status::ok ||
                  trouble_.damaged_one_in > 0);
      one.waiting.erase(one.waiting.begin());
    }
    if (one.receiver->wants_hello()) {
      const auto hello = one.client->hello();
      ASSERT_TRUE(hello.ok());
      ASSERT_EQ(one.receiver->take(*hello), Status::ok);
    }
    const auto messages = one.receiver->take_messages();
    ASSERT_TRUE(messages.ok());
    for (const Message& message : *messages) {
      ASSERT_EQ(one.client->receive(message), Status::ok);
    }
    reply(one);
    ASSERT_EQ(one.client->statistics().failed_proofs, 0U);
    // Choices are for the volumes of an epoch.
    if (one.chose != 0 && one.chose != epoch_) choose(one);
    fetch(one);
    // With limits a part of an update may come with later ones.
    if (!limited_ && one.receiver->complete() && one.client->consistent()) compare(one);
  }

  void fetch(Audience& one) {
    const auto requests = one.receiver->take_requests();
    ASSERT_TRUE(requests.ok());
    const Kept& from = trouble_.broker_lags ? history_.front() : kept_;
    if (requests->list && !from.list.empty()) send(one, from.list);
    if (requests->list && !from.tick.empty()) send(one, from.tick);
    for (const auto& [stream, number] : requests->objects) {
      const auto found = from.objects.find({stream, number});
      if (found != from.objects.end()) send(one, found->second);
    }
  }

  /// What the client holds of what it wants is what was published.
  void compare(Audience& one) {
    const ClientFrame& frame = one.client->frame();
    if (frame.epoch != epoch_ || frame.update == 0) return;
    if (one.chose != 0 && one.chose != epoch_) return;
    const State& state = states_.at(frame.update);
    for (std::uint16_t v = 0; v < volumes_.size(); ++v) {
      const ClientVolume* const volume = frame.find(v);
      ASSERT_NE(volume, nullptr);
      std::uint8_t id = 0;
      for (std::size_t group = 0; group < volume->desc.groups.size(); ++group) {
        for (std::size_t t = 0; t < volume->desc.groups[group].textures.size(); ++t, ++id) {
          const ClientTexture& texture = volume->textures[id];
          for (std::uint32_t b = 0; b < texture.changed.size(); ++b) {
            if (texture.changed[b] == 0) {
              const bool wanted = one.wanted.empty() || one.wanted[v][group][b] != 0;
              const bool there = !state[v][id][b].empty();
              // What has entered is unknown until its turn, and what was never published.
              ASSERT_TRUE(!wanted || !there || volumes_[v]->streamed()[id].interval > 1 || limited_)
                  << "texture " << int{id} << " block " << b << " update " << frame.update;
              continue;
            }
            if (!one.wanted.empty() && one.wanted[v][group][b] == 0) continue;
            ASSERT_EQ(block_of(texture.desc, texture.texels, b), state[v][id][b]);
            ++one.compared;
          }
        }
      }
    }
  }

  Random& random_;
  Grid region_;
  std::vector<std::unique_ptr<AnyVolume>> volumes_;
  std::optional<Server> server_;
  std::optional<TrackPublisher> publisher_;
  std::uint64_t epoch_ = 0, step_ = 0;
  Kept kept_;
  std::deque<Kept> history_;
  Trouble trouble_;
  bool limited_ = false;                   ///< the server makes few snapshots in an update
  std::map<std::uint64_t, State> states_;  ///< of this epoch, by update
  std::vector<std::unique_ptr<Audience>> audience_;
};

struct TrackCounts {
  std::uint64_t compared = 0, proofs = 0, snapshots = 0;
};
TrackCounts run_track_world(std::uint64_t seed) {
  SCOPED_TRACE(seed);
  Random random(seed);
  TrackWorld world(random);
  world.join();
  const int steps = static_cast<int>(pick(random, 5, 60));
  for (int step = 0; step < steps && !testing::Test::HasFailure(); ++step) {
    world.step(false);
    if (chance(random, 10)) world.join();
  }
  if (!testing::Test::HasFailure()) world.settle();
  return {world.compared, world.proofs, world.statistics.snapshots};
}

RC_GTEST_PROP(TrackSimulation, ReceiversShowWhatWasPublished, (std::uint64_t seed)) {
  run_track_world(seed);
  RC_ASSERT(!testing::Test::HasFailure());
}

/// A bundle whose presence comes by a snapshot, and other textures by updates before it.
TEST(TrackSimulation, PresenceThatSkipsUpdates) { run_track_world(28956); }

TEST(TrackSimulation, ManySchedules) {
  const std::uint64_t schedules = everything() ? 500 : 180 / one_case_in();
  TrackCounts all;
  for (std::uint64_t seed = 0; seed < schedules && !testing::Test::HasFailure(); ++seed) {
    const TrackCounts one = run_track_world(seed);
    all.compared += one.compared;
    all.proofs += one.proofs;
    all.snapshots += one.snapshots;
  }
  EXPECT_GT(all.compared, 100 * schedules);
  EXPECT_GT(all.proofs, 20 * schedules);
  EXPECT_GT(all.snapshots, 5 * schedules);
}

}  // namespace
}  // namespace gicodec
