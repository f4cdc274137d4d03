// A server and its clients over random schedules of change, views, budgets, lost links and returns:
// after every update each client holds what the server thinks it holds.
#include "session/any_volume.h"

#include <gicodec/decoder.h>
#include "session/server/distributor.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>

namespace gicodec {
namespace {

using namespace test;

/// A chain of packets at the receiver.
struct Chain {
  Decoder decoder;
  std::vector<std::uint32_t> blocks;  ///< in the volume
};

using Contents = std::vector<std::vector<Bytes>>;  ///< by texture and block

struct Receiver {
  ClientId id = 0;
  Delivery delivery = Delivery::unicast;
  Budget budget;
  bool connected = true, suspended = false;
  std::vector<BlockMask> visible;  ///< by group
  std::map<StreamId, Chain> chains;
};

class DistributorWorld {
 public:
  DistributorWorld(Random& random, const char* backend) : random_(random), volume_(random) {
    options_.backend = backend;
    options_.threads = pick(random, 1, 3);
    options_.settings.isa = any_isa(random);
    options_.region = {pick(random, 1, 4), pick(random, 1, 4), pick(random, 1, 4)};
    options_.max_unacknowledged = pick(random, 0, 4);
    auto made = Distributor::create(options_);
    EXPECT_TRUE(made.ok());
    distributor_.emplace(*std::move(made));
    EXPECT_EQ(
        distributor_->add_volume(volume_.desc(), volume_.geometry(), volume_.streamed()).status(),
        Status::ok);
    active_.resize(groups());
  }

  [[nodiscard]] std::size_t groups() const { return volume_.desc().groups.size(); }
  [[nodiscard]] std::uint32_t total() const {
    std::uint32_t blocks = 0;
    for (std::size_t group = 0; group < groups(); ++group) {
      blocks += volume_.blocks(group) *
                static_cast<std::uint32_t>(volume_.desc().groups[group].textures.size());
    }
    return blocks;
  }

  void connect(Delivery delivery) {
    Receiver receiver;
    receiver.delivery = delivery;
    if (delivery == Delivery::unicast && chance(random_, 2)) {
      if (chance(random_, 2)) receiver.budget.blocks = pick(random_, 1, total());
      if (chance(random_, 2)) receiver.budget.bytes = pick(random_, 100, 3000);
    } else if (delivery == Delivery::shared && chance(random_, 2)) {
      receiver.budget.bytes = pick(random_, 20, 5000);
    }
    const auto id = distributor_->connect(delivery, receiver.budget);
    ASSERT_TRUE(id.ok());
    receiver.id = *id;
    constexpr double kThroughputs[] = {0, 1, 1e12};
    ASSERT_EQ(distributor_->set_throughput(*id, kThroughputs[random_() % 3]), Status::ok);
    receivers_.push_back(std::move(receiver));
    look(receivers_.back());
  }

  void look(Receiver& receiver) {
    receiver.visible.resize(groups());
    for (std::uint8_t group = 0; group < groups(); ++group) {
      receiver.visible[group] = any_mask(group);
      ASSERT_EQ(distributor_->set_visible(receiver.id, 0, receiver.visible[group], group),
                Status::ok);
    }
  }

  void change() {
    volume_.change(random_, [&](std::uint8_t texture, ConstTextureView view) {
      return distributor_->publish(0, texture, view);
    });
  }

  void step(bool still = false) {
    if (!still) {
      change();
      for (Receiver& receiver : receivers_) disturb(receiver);
      if (chance(random_, 6)) {
        const auto group = static_cast<std::uint8_t>(random_() % groups());
        active_[group] = any_mask(group);
        for (auto& one : active_[group]) one = one == 0 ? 1 : 0;
        ASSERT_EQ(distributor_->set_active(0, active_[group], group), Status::ok);
      }
    }
    // Presets change.
    distributor_->report_update_time(chance(random_, 12) ? 2 : 0.1, 1);
    ASSERT_EQ(distributor_->update(), Status::ok);
    volume_.updated(distributor_->updates());
    remember();
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
      const bool limited = receiver.budget.bytes != 0 || receiver.budget.blocks != 0;
      const std::uint32_t at_once =
          receiver.budget.bytes != 0 ? 1 : std::max(1U, receiver.budget.blocks);
      if (limited) steps = std::max(steps, 4 + 2 * 2 * 2 * (total() / at_once + 1));
      // The slowest rate, and room for one region in an update.
      if (receiver.delivery == Delivery::shared) steps += 2 * 32 + 2 * total();
    }
    const auto settled = [&](Receiver& receiver) { return missing(receiver) == 0; };
    for (std::uint32_t i = 0; i < steps && !testing::Test::HasFailure(); ++i) {
      step(true);
      if (i >= 4 && std::ranges::all_of(receivers_, settled)) break;
    }
    for (Receiver& receiver : receivers_) {
      EXPECT_EQ(missing(receiver), 0U);
      const auto state = distributor_->state(receiver.id);
      ASSERT_TRUE(state.ok());
      EXPECT_EQ(state->pending, 0U);
      EXPECT_EQ(state->oldest_pending, 0U);
    }
  }

 private:
  BlockMask any_mask(std::size_t group) {
    BlockMask mask(volume_.blocks(group));
    for (const auto block : random_selection(random_, volume_.blocks(group))) mask[block] = 1;
    return mask;
  }

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
        ASSERT_EQ(distributor_->acknowledge(receiver.id, stream, chain.decoder.sequence()),
                  Status::ok);
      }
    }
  }

  void suspend(Receiver& receiver, bool suspended) {
    receiver.suspended = suspended;
    ASSERT_EQ(distributor_->suspend(receiver.id, suspended), Status::ok);
  }

  void reconnect(Receiver& receiver) {
    suspend(receiver, false);
    if (receiver.connected) return;
    receiver.connected = true;
    for (std::uint8_t i = 0; i < volume_.streamed().size(); ++i) {
      const StreamId stream{0, i, StreamId::kWholeVolume};
      const auto it = receiver.chains.find(stream);
      const bool any = it != receiver.chains.end();
      ASSERT_EQ(distributor_->resume(receiver.id, stream, any ? it->second.decoder.sequence() : 0,
                                     any ? it->second.decoder.checksum() : 0),
                Status::ok);
    }
  }

  Chain& chain_of(Receiver& receiver, StreamId stream) {
    const auto found = receiver.chains.find(stream);
    if (found != receiver.chains.end()) return found->second;
    TextureDesc desc = volume_.texture(stream.texture);
    std::vector<std::uint32_t> blocks(block_count(desc));
    std::iota(blocks.begin(), blocks.end(), 0U);
    if (stream.region != StreamId::kWholeVolume) {
      blocks = regions_of(desc, options_.region).blocks_of(stream.region);
      desc = region_texture(desc, options_.region, stream.region);
    }
    auto decoder = Decoder::create(desc);
    EXPECT_TRUE(decoder.ok());
    return receiver.chains.emplace(stream, Chain{*std::move(decoder), std::move(blocks)})
        .first->second;
  }

  void remember() {
    Contents now(volume_.streamed().size());
    for (std::uint8_t id = 0; id < now.size(); ++id) {
      for (std::uint32_t block = 0; block < block_count(volume_.texture(id)); ++block) {
        now[id].push_back(volume_.block(id, block, true));
      }
    }
    if (past_.empty() || past_.back() != now) past_.push_back(std::move(now));
  }

  void deliver(Receiver& receiver) {
    const auto before = naming_held(receiver);
    std::uint64_t bytes = 0;
    std::uint32_t blocks = 0;
    std::map<StreamId, std::set<std::uint32_t>> received;
    for (const OutgoingPacket& packet : distributor_->packets(receiver.id)) {
      Chain& chain = chain_of(receiver, packet.stream);
      if (const auto presence = volume_.presence_of(packet.stream.texture)) {
        StreamId of = packet.stream;
        of.texture = *presence;
        ASSERT_EQ(chain.decoder.set_presence(chain_of(receiver, of).decoder.records()), Status::ok);
      }
      ASSERT_EQ(chain.decoder.decode(*packet.packet), Status::ok);
      const auto info = *peek(*packet.packet);
      EXPECT_EQ(info.texture_id, packet.stream.texture);
      EXPECT_EQ(info.sequence, packet.sequence);
      EXPECT_EQ(is_keyframe(info.type), packet.keyframe);
      bytes += packet.packet->size();
      blocks += packet.blocks;
      for (const std::uint32_t block : listed_blocks(chain.decoder, *packet.packet)) {
        received[packet.stream].insert(chain.blocks[block]);
      }
    }
    const std::uint32_t most = largest_lot();
    if (receiver.budget.blocks != 0) {
      EXPECT_LE(blocks, std::max(receiver.budget.blocks, most));
    }
    if (receiver.delivery == Delivery::unicast && receiver.budget.bytes != 0 && blocks > most) {
      EXPECT_LE(bytes, receiver.budget.bytes);
    }
    check_together(received);
    check_named(receiver, received, before);
  }

  /// Textures of the largest group that travels together.
  [[nodiscard]] std::uint32_t largest_lot() const {
    std::size_t most = 1;
    for (const TextureGroup& group : volume_.desc().groups) {
      if (group.bundled) most = std::max(most, group.textures.size());
    }
    return static_cast<std::uint32_t>(most);
  }

  /// What travels together came in all textures, or keyframes brought what others had before.
  void check_together(const std::map<StreamId, std::set<std::uint32_t>>& received) {
    for (const auto& [stream, blocks] : received) {
      for (std::size_t group = 0; group < groups(); ++group) {
        const std::uint8_t first = volume_.first_of(group), end = volume_.first_of(group + 1);
        if (!volume_.desc().groups[group].bundled || stream.texture < first ||
            stream.texture >= end) {
          continue;
        }
        for (StreamId other = stream; other.texture < end; ++other.texture) {
          const auto found = received.find(other);
          ASSERT_TRUE(found != received.end());
          EXPECT_EQ(found->second, blocks);
        }
      }
    }
  }

  using Naming = std::map<std::pair<std::uint8_t, std::uint32_t>, std::optional<Bytes>>;
  /// What a receiver holds of blocks that name others.
  Naming naming_held(Receiver& receiver) {
    Naming held;
    for (std::size_t group = 0; group < groups(); ++group) {
      if (volume_.desc().groups[group].depends_on == TextureGroup::kNone) continue;
      for (std::uint8_t id = volume_.first_of(group); id < volume_.first_of(group + 1); ++id) {
        for (std::uint32_t block = 0; block < volume_.blocks(group); ++block) {
          held[{id, block}] = held_of(receiver, id, block);
        }
      }
    }
    return held;
  }

  /// What came names nothing that the receiver does not have; where it is what is current, no
  /// contents of that are older than what it had `before` of the naming block, and without a budget
  /// they are the newest when it is its turn.
  void check_named(Receiver& receiver, const std::map<StreamId, std::set<std::uint32_t>>& received,
                   const Naming& before) {
    for (std::size_t group = 0; group < groups(); ++group) {
      const std::uint8_t names = volume_.desc().groups[group].depends_on;
      if (names == TextureGroup::kNone) continue;
      for (const auto& [stream, blocks] : received) {
        if (stream.texture != volume_.first_of(group)) continue;
        for (const std::uint32_t block : blocks) {
          const auto held = held_of(receiver, stream.texture, block);
          const auto& had = before.at({stream.texture, block});
          if (!held || held == had) continue;
          std::size_t oldest = 0;
          const bool current = *held == volume_.block(stream.texture, block, true);
          const bool due =
              distributor_->updates() % volume_.streamed()[stream.texture].interval == 0;
          if (current && due && receiver.budget.bytes == 0 && receiver.budget.blocks == 0) {
            oldest = past_.size() - 1;
          } else if (current && had && receiver.delivery == Delivery::unicast) {
            const auto end = volume_.desc().groups[group].bundled ? volume_.first_of(group + 1)
                                                                  : stream.texture + 1;
            const auto differs = [&, first = stream.texture, block](const Contents& past) {
              for (std::uint8_t id = first; id < end; ++id) {
                if (past[id][block] != before.at({id, block})) return true;
              }
              return false;
            };
            oldest = past_.size();
            while (oldest > 0 && differs(past_[oldest - 1])) --oldest;
          }
          for (const std::uint32_t name : volume_.dependencies(group, *held)) {
            if (!active_[names].empty() && active_[names][name] == 0) continue;
            const auto first = volume_.first_of(names), end = volume_.first_of(names + 1U);
            for (std::uint8_t id = first; id < end; ++id) {
              const auto there = held_of(receiver, id, name);
              ASSERT_TRUE(there.has_value());
              EXPECT_TRUE(
                  std::any_of(past_.begin() + static_cast<std::ptrdiff_t>(oldest), past_.end(),
                              [&](const Contents& past) { return past[id][name] == *there; }));
            }
          }
        }
      }
    }
  }

  /// What the receiver holds of every stream is what the server thinks.
  void check_hashes(Receiver& receiver) {
    for (const auto& [stream, chain] : receiver.chains) {
      const auto hash = distributor_->state_hash(receiver.id, stream);
      if (hash) {
        EXPECT_EQ(*hash, chain.decoder.state_hash());
      }
    }
  }

  std::optional<Bytes> held_of(Receiver& receiver, std::uint8_t texture, std::uint32_t block) {
    StreamId stream{0, texture, StreamId::kWholeVolume};
    if (receiver.delivery == Delivery::shared) {
      stream.region = regions_of(volume_.texture(texture), options_.region).region_of(block);
    }
    const auto found = receiver.chains.find(stream);
    if (found == receiver.chains.end()) return std::nullopt;
    const auto& [decoder, blocks] = found->second;
    const auto place =
        static_cast<std::uint32_t>(std::ranges::find(blocks, block) - blocks.begin());
    if (decoder.received()[place] == 0) return std::nullopt;
    Texture copy(decoder.desc());
    EXPECT_EQ(decoder.read(copy.view(), std::span(&place, 1)), Status::ok);
    return copy.block(place);
  }

  /// Blocks that the client wants and that are not the current ones.
  std::uint32_t missing(Receiver& receiver) {
    return volume_.missing(receiver.visible, active_,
                           [&](std::uint8_t texture, std::uint32_t block) {
                             return held_of(receiver, texture, block);
                           });
  }

  void check(Receiver& receiver) {
    const bool all_due = std::ranges::all_of(volume_.streamed(), [&](const StreamedTexture& one) {
      return distributor_->updates() % one.interval == 0;
    });
    if (!all_due) return;
    const auto state = distributor_->state(receiver.id);
    ASSERT_TRUE(state.ok());
    check_hashes(receiver);
    if (receiver.delivery == Delivery::shared && (receiver.suspended || receiver.budget.bytes != 0))
      return;
    EXPECT_EQ(missing(receiver), state->pending);
    if (receiver.budget.blocks == 0 && receiver.budget.bytes == 0) {
      EXPECT_EQ(state->pending, 0U);
    }
  }

  Random& random_;
  AnyVolume volume_;
  DistributorOptions options_;
  std::optional<Distributor> distributor_;
  std::vector<Receiver> receivers_;
  std::vector<BlockMask> active_;  ///< by group

  std::vector<Contents> past_;  ///< of all updates that differ
};

void run_distributor_world(std::uint64_t seed, const char* backend) {
  SCOPED_TRACE(seed);
  Random random(seed);
  DistributorWorld world(random, backend);
  const auto clients = pick(random, 1, 4);
  for (std::uint32_t i = 0; i < clients; ++i) {
    world.connect(chance(random, 3) ? Delivery::shared : Delivery::unicast);
  }
  for (int step = 0; step < 12 && !testing::Test::HasFailure(); ++step) {
    world.step();
    if (chance(random, 10)) world.connect(chance(random, 2) ? Delivery::shared : Delivery::unicast);
  }
  if (!testing::Test::HasFailure()) world.settle();
}

RC_GTEST_PROP(Distributor, ClientsHoldWhatTheServerThinks, (std::uint64_t seed)) {
  run_distributor_world(seed, "zstd");
  RC_ASSERT(!testing::Test::HasFailure());
}

RC_GTEST_PROP(Distributor, WithTheNativeCodec, (std::uint64_t seed)) {
  run_distributor_world(seed, "native");
  RC_ASSERT(!testing::Test::HasFailure());
}

/// A region's streams keep what an inactive block held, while its current contents name others; and
/// what was published names others than what came, as it was not its turn yet.
TEST(Distributor, WhatBlocksNameIsWhatWasSent) {
  for (const std::uint64_t seed : {9265, 11690}) run_distributor_world(seed, "zstd");
}

}  // namespace
}  // namespace gicodec
