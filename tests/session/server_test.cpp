// A server and its clients over random schedules of change, views, budgets, lost links and returns:
// after every update each client holds what the server thinks it holds.
#include "support.h"

#include <gicodec/server.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace gicodec {
namespace {

using namespace test;

/// A chain of packets at the receiver.
struct Chain {
  Decoder decoder;
  std::vector<std::uint32_t> probes;  ///< in the volume
};

struct Receiver {
  ClientId id = 0;
  Delivery delivery = Delivery::own;
  Budget budget;
  bool connected = true, suspended = false;
  ProbeMask visible;
  std::map<StreamId, Chain> chains;
};

class World {
 public:
  World(Random& random, const char* backend)
      : random_(random), grid_{pick(random, 1, 5), pick(random, 1, 4), pick(random, 1, 5)} {
    options_.backend = backend;
    options_.threads = pick(random, 1, 3);
    options_.settings.isa = any_isa(random);
    options_.chunk = {pick(random, 1, 4), pick(random, 1, 4), pick(random, 1, 4)};
    options_.max_unacknowledged = pick(random, 0, 4);
    auto made = Server::create(options_);
    EXPECT_TRUE(made.ok());
    server_.emplace(*std::move(made));
    std::vector<StreamedTexture> textures;
    for (int i = 0; i < 2; ++i) {
      TextureDesc desc = random_desc(random, 1000);
      desc.grid = grid_;
      desc.core = static_cast<std::uint16_t>(pick(random, 1, 6));
      textures.push_back({desc, pick(random, 1, 2), 0});
      textures_.push_back(std::make_unique<Texture>(desc));
    }
    intervals_ = {textures[0].interval, textures[1].interval};
    const auto volume = server_->add_volume({grid_, {}, {1, 1, 1}}, textures);
    EXPECT_TRUE(volume.ok());
  }

  [[nodiscard]] std::uint32_t total() const { return grid_.x * grid_.y * grid_.z; }

  void connect(Delivery delivery) {
    Receiver receiver;
    receiver.delivery = delivery;
    if (delivery == Delivery::own && chance(random_, 2)) {
      if (chance(random_, 2)) receiver.budget.probes = pick(random_, 1, total());
      if (chance(random_, 2)) receiver.budget.bytes = pick(random_, 100, 3000);
    } else if (delivery == Delivery::shared && chance(random_, 2)) {
      receiver.budget.bytes = pick(random_, 20, 5000);
    }
    const auto id = server_->connect(delivery, receiver.budget);
    ASSERT_TRUE(id.ok());
    receiver.id = *id;
    receivers_.push_back(std::move(receiver));
    look(receivers_.back());
  }

  void look(Receiver& receiver) {
    receiver.visible.assign(total(), 0);
    for (const auto probe : random_selection(random_, total())) receiver.visible[probe] = 1;
    ASSERT_EQ(server_->set_visible(receiver.id, 0, receiver.visible), Status::ok);
  }

  void change() {
    for (std::uint8_t i = 0; i < textures_.size(); ++i) {
      if (chance(random_, 4)) continue;
      Texture& texture = *textures_[i];
      for (const auto probe : random_selection(random_, total())) {
        texture.fill_core(probe, chance(random_, 4) ? Fill::zero : Fill::noise, random_);
        if (!chance(random_, 4)) texture.fill_border(probe);
      }
      ASSERT_EQ(server_->publish(0, i, std::as_const(texture).view()), Status::ok);
    }
  }

  void step(bool still = false) {
    if (!still) {
      change();
      for (Receiver& receiver : receivers_) disturb(receiver);
      if (chance(random_, 6)) {
        active_.assign(total(), 1);
        for (const auto probe : random_selection(random_, total())) active_[probe] = 0;
        ASSERT_EQ(server_->set_active(0, active_), Status::ok);
      }
    }
    ASSERT_EQ(server_->update(), Status::ok);
    for (Receiver& receiver : receivers_) {
      if (!receiver.connected) continue;
      deliver(receiver);
      check(receiver);
    }
  }

  /// Everything visible arrives within a bounded number of updates when nothing changes any more.
  void settle() {
    std::uint32_t steps = 4;
    for (Receiver& receiver : receivers_) {
      reconnect(receiver);
      const bool limited = receiver.budget.bytes != 0 || receiver.budget.probes != 0;
      const std::uint32_t at_once =
          receiver.budget.bytes != 0 ? 1 : std::max(1U, receiver.budget.probes);
      if (limited) steps = std::max(steps, 4 + 2 * 2 * 2 * ((2 * total()) / at_once + 1));
      // The slowest rate, and room for one chunk in an update.
      if (receiver.delivery == Delivery::shared) steps += 2 * 32 + 2 * total();
    }
    const auto settled = [&](Receiver& receiver) { return missing(receiver) == 0; };
    for (std::uint32_t i = 0; i < steps && !testing::Test::HasFailure(); ++i) {
      step(true);
      if (i >= 4 && std::ranges::all_of(receivers_, settled)) break;
    }
    for (Receiver& receiver : receivers_) {
      EXPECT_EQ(missing(receiver), 0U);
      const auto state = server_->state(receiver.id);
      ASSERT_TRUE(state.ok());
      EXPECT_EQ(state->owed, 0U);
      EXPECT_EQ(state->oldest_owed, 0U);
    }
  }

 private:
  void disturb(Receiver& receiver) {
    if (chance(random_, 4)) look(receiver);
    if (receiver.delivery == Delivery::shared) {
      if (chance(random_, 3)) suspend(receiver, !receiver.suspended);
      return;
    }
    if (receiver.connected && chance(random_, 5)) {
      receiver.connected = false;  // From here on its packets are lost.
    } else if (!receiver.connected && chance(random_, 2)) {
      reconnect(receiver);
    }
    if (receiver.connected && chance(random_, 2)) {
      for (auto& [stream, chain] : receiver.chains) {
        if (chain.decoder.sequence() == 0) continue;
        ASSERT_EQ(server_->acknowledge(receiver.id, stream, chain.decoder.sequence()), Status::ok);
      }
    }
  }

  void suspend(Receiver& receiver, bool suspended) {
    receiver.suspended = suspended;
    ASSERT_EQ(server_->suspend(receiver.id, suspended), Status::ok);
  }

  void reconnect(Receiver& receiver) {
    suspend(receiver, false);
    if (receiver.connected) return;
    receiver.connected = true;
    for (std::uint8_t i = 0; i < textures_.size(); ++i) {
      const StreamId stream{0, i, StreamId::kWholeVolume};
      const auto it = receiver.chains.find(stream);
      const bool any = it != receiver.chains.end();
      ASSERT_EQ(server_->resume(receiver.id, stream, any ? it->second.decoder.sequence() : 0,
                                any ? it->second.decoder.checksum() : 0),
                Status::ok);
    }
  }

  Chain& chain_of(Receiver& receiver, StreamId stream) {
    const auto found = receiver.chains.find(stream);
    if (found != receiver.chains.end()) return found->second;
    TextureDesc desc = textures_[stream.texture]->desc();
    std::vector<std::uint32_t> probes(total());
    std::iota(probes.begin(), probes.end(), 0U);
    if (stream.chunk != StreamId::kWholeVolume) {
      const ChunkGrid chunks(grid_, options_.chunk);
      desc.grid = chunks.grid_of(stream.chunk);
      probes = chunks.probes_of(stream.chunk);
    }
    auto decoder = Decoder::create(desc);
    EXPECT_TRUE(decoder.ok());
    return receiver.chains.emplace(stream, Chain{*std::move(decoder), std::move(probes)})
        .first->second;
  }

  void deliver(Receiver& receiver) {
    std::uint64_t bytes = 0;
    std::uint32_t probes = 0;
    for (const OutgoingPacket& packet : server_->packets(receiver.id)) {
      Chain& chain = chain_of(receiver, packet.stream);
      ASSERT_EQ(chain.decoder.decode(*packet.packet), Status::ok);
      EXPECT_EQ(peek(*packet.packet)->texture_id, packet.stream.texture);
      bytes += packet.packet->size();
      probes += packet.probes;
    }
    if (receiver.budget.probes != 0) {
      EXPECT_LE(probes, receiver.budget.probes);
    }
    if (receiver.delivery == Delivery::own && receiver.budget.bytes != 0 && probes > 1) {
      EXPECT_LE(bytes, receiver.budget.bytes);
    }
  }

  /// What the receiver holds of every stream is what the server thinks.
  void check_hashes(Receiver& receiver) {
    for (const auto& [stream, chain] : receiver.chains) {
      const auto hash = server_->state_hash(receiver.id, stream);
      if (hash) {
        EXPECT_EQ(*hash, chain.decoder.state_hash());
      }
    }
  }

  /// Blocks that the client sees and that are not the current ones.
  std::uint32_t missing(Receiver& receiver) {
    std::uint32_t count = 0;
    for (std::uint8_t i = 0; i < textures_.size(); ++i) {
      const Texture& texture = *textures_[i];
      std::vector<Bytes> blocks(total(), Bytes(texture.block(0).size()));
      for (auto& [stream, chain] : receiver.chains) {
        if (stream.texture != i) continue;
        const Bytes held = contents(chain.decoder);
        const std::size_t size = held.size() / chain.probes.size();
        for (std::size_t p = 0; p < chain.probes.size(); ++p) {
          const auto block = std::span(held).subspan(p * size, size);
          blocks[chain.probes[p]].assign(block.begin(), block.end());
        }
      }
      for (std::uint32_t probe = 0; probe < total(); ++probe) {
        if (receiver.visible[probe] == 0 || (!active_.empty() && active_[probe] == 0)) continue;
        count += blocks[probe] != texture.block(probe);
      }
    }
    return count;
  }

  void check(Receiver& receiver) {
    const bool all_due = std::ranges::all_of(
        intervals_, [&](std::uint32_t interval) { return server_->updates() % interval == 0; });
    if (!all_due) return;
    const auto state = server_->state(receiver.id);
    ASSERT_TRUE(state.ok());
    check_hashes(receiver);
    if (receiver.delivery == Delivery::shared && (receiver.suspended || receiver.budget.bytes != 0))
      return;
    EXPECT_EQ(missing(receiver), state->owed);
    if (receiver.budget.probes == 0 && receiver.budget.bytes == 0) {
      EXPECT_EQ(state->owed, 0U);
    }
  }

  Random& random_;
  Grid grid_;
  ServerOptions options_;
  std::optional<Server> server_;
  std::vector<std::unique_ptr<Texture>> textures_;
  std::vector<std::uint32_t> intervals_;
  std::vector<Receiver> receivers_;
  ProbeMask active_;
};

void run_world(std::uint64_t seed, const char* backend) {
  Random random(seed);
  World world(random, backend);
  const auto clients = pick(random, 1, 4);
  for (std::uint32_t i = 0; i < clients; ++i) {
    world.connect(chance(random, 3) ? Delivery::shared : Delivery::own);
  }
  for (int step = 0; step < 12 && !testing::Test::HasFailure(); ++step) {
    world.step();
    if (chance(random, 10)) world.connect(chance(random, 2) ? Delivery::shared : Delivery::own);
  }
  if (!testing::Test::HasFailure()) world.settle();
}

RC_GTEST_PROP(Server, ClientsHoldWhatTheServerThinks, (std::uint64_t seed)) {
  run_world(seed, "zstd");
  RC_ASSERT(!testing::Test::HasFailure());
}

RC_GTEST_PROP(Server, WithTheNativeCodec, (std::uint64_t seed)) {
  run_world(seed, "native");
  RC_ASSERT(!testing::Test::HasFailure());
}

}  // namespace
}  // namespace gicodec
