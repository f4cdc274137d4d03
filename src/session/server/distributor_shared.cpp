// The subscribers of regions, what they hold, and the packets they get. Late clients get a
// snapshot, slower ones catch-ups, and then the same packets as the others.
#include "base/guard.h"
#include "session/server/distributor_state.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gicodec {
namespace {

/// States of a region kept for lagging clients.
constexpr std::size_t kMaxLagging = 12;
/// Catch-ups of a region in one update: more than four groups at all rates need on average.
constexpr std::size_t kMaxCatchUps = 4;
/// Turns from a keyframe of a stateful backend to the next that lagging clients may cause.
constexpr std::uint64_t kKeyframeTurns = 16;
/// An update may exceed the budget, which limits the average, by this factor.
constexpr float kBurst = 2;

/// True if the client of these subscriptions, one per texture, holds the given states.
bool holds(std::span<const Subscription> subscriptions,
           std::span<const StreamState> states) noexcept {
  return std::equal(subscriptions.begin(), subscriptions.end(), states.begin(), states.end(),
                    [](const Subscription& subscription, const StreamState& state) {
                      return state.is(subscription.sequence, subscription.checksum);
                    });
}

/// True if the client of these subscriptions holds the streams' state.
bool is_current(const SharedRegion& shared, std::span<const Subscription> subscriptions) noexcept {
  return std::equal(subscriptions.begin(), subscriptions.end(), shared.streams.begin(),
                    shared.streams.end(),
                    [](const Subscription& subscription, const UpdateStream& stream) {
                      return !stream.keyframe_next() &&
                             stream.state().is(subscription.sequence, subscription.checksum);
                    });
}

template <typename Shared>
auto find_lagging(Shared& shared, std::span<const Subscription> subscriptions) noexcept {
  return std::find_if(shared.lagging.begin(), shared.lagging.end(),
                      [&](const Lagging& one) { return holds(subscriptions, one.states); });
}

SubscriberGroup& group_of(SharedRegion& shared,
                          std::span<const Subscription> subscriptions) noexcept {
  if (is_current(shared, subscriptions)) return shared.up_to_date;
  const auto lagging = find_lagging(shared, subscriptions);
  return lagging != shared.lagging.end() ? lagging->subscribers : shared.waiting;
}

/// A number below `count` that differs from update to update, spread evenly.
std::size_t spread(std::uint64_t update, std::size_t count) noexcept {
  constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15;
  return count == 0 ? 0 : (update * kGolden >> 32) % count;
}

}  // namespace

/// True if the client gets packets of a region in this update. Keyframes of stateful backends do
/// not keep to the turns of slow clients, which get the next one after their turn.
bool Distributor::State::takes_part(const ServedClient& client, const Bundle& bundle,
                                    std::size_t place,
                                    std::span<const Subscription> subscriptions) const noexcept {
  return subscriptions[0].owed || client.rate.turn(bundle.turn(updates), place);
}

/// Calls visit(volume, bundle, region, place, subscriptions, shared) for each region that a client
/// subscribes to.
template <typename Visit>
void Distributor::State::for_each_subscription(ServedClient& client, const Visit& visit) noexcept {
  std::size_t place = 0;
  for (const auto& volume : volumes) {
    for (std::size_t l = 0; l < volume->bundles.size(); ++l) {
      Bundle& bundle = *volume->bundles[l];
      for (std::uint32_t region = 0; region < bundle.regions.size(); ++region, ++place) {
        const auto subscriptions = client.subscriptions_of(volume->id(), l, bundle, region);
        if (subscriptions[0].subscribed)
          visit(*volume, bundle, region, place, subscriptions, bundle.regions[region]);
      }
    }
  }
}

/// Before an update: counts the subscribers of each state, and those whose turn it is.
void Distributor::State::gather_subscribers() noexcept {
  for (const auto& entry : clients) {
    ServedClient& client = *entry.second;
    if (client.delivery != Delivery::shared) continue;
    std::size_t regions = 0, bytes = 0;
    for_each_subscription(client,
                          [&](const ServedVolume&, const Bundle&, std::uint32_t, std::size_t,
                              std::span<const Subscription>, const SharedRegion& shared) {
                            ++regions;
                            bytes += shared.bytes;
                          });
    client.rate.choose(client.budget, regions, bytes / std::max<std::size_t>(regions, 1));
    for_each_subscription(
        client, [&](const ServedVolume&, const Bundle& bundle, std::uint32_t, std::size_t place,
                    std::span<const Subscription> subscriptions, SharedRegion& shared) {
          SubscriberGroup& subscribers = group_of(shared, subscriptions);
          ++subscribers.all;
          if (!client.suspended && takes_part(client, bundle, place, subscriptions))
            ++subscribers.served;
        });
  }
}

/// Chooses the snapshots and catch-ups within the block limit: oldest states first, regions in an
/// order that differs from update to update.
void Distributor::State::allot_catch_ups() noexcept {
  std::size_t regions = 0;
  for_each_region([&](auto&&...) { ++regions; });
  const std::size_t start = spread(updates, regions);
  std::uint64_t left = limit_for_few == 0 ? UINT64_MAX : limit_for_few;
  const auto allot = [&](SubscriberGroup& subscribers, std::uint64_t blocks) {
    if (subscribers.served == 0 || left == 0) return false;
    left -= std::min(left, blocks);
    return subscribers.allotted = true;
  };
  for (const bool wrapped : {false, true}) {
    std::size_t place = 0;
    for_each_region([&](const ServedVolume&, const Bundle& bundle, SharedRegion& shared) {
      if ((place++ < start) != wrapped) return;
      if (bundle.is_stateful && shared.keyframe_turn != 0 &&
          bundle.turn(updates) - shared.keyframe_turn < kKeyframeTurns) {
        return;
      }
      const std::uint64_t blocks = std::uint64_t{shared.streams[0].size()} * bundle.textures.size();
      std::size_t catch_ups = 0;
      for (Lagging& lagging : shared.lagging) {
        if (catch_ups < kMaxCatchUps && allot(lagging.subscribers, blocks)) ++catch_ups;
      }
      allot(shared.waiting, blocks);
    });
  }
}

std::uint32_t Distributor::pending_shared(ClientId client) const noexcept {
  ServedClient* const found = state_->find(client);
  if (found == nullptr || found->delivery != Delivery::shared) return 0;
  std::uint32_t blocks = 0;
  const auto count = [&](const ServedVolume& volume, const Bundle& bundle, std::uint32_t,
                         std::size_t, std::span<const Subscription> subscriptions,
                         SharedRegion& shared) {
    const bool all = !is_current(shared, subscriptions);
    for (std::uint32_t block = 0; block < shared.streams[0].size(); ++block) {
      if (!volume.is_active(bundle.group_id, shared.streams[0].volume_block(block))) continue;
      if (all || bundle.outdated(shared.streams, block)) ++blocks;
    }
  };
  state_->for_each_subscription(*found, count);
  return blocks;
}

/// True if the client holds all that the blocks of a region depend on, in versions that were
/// current at some time since its state of that region is outdated.
bool Distributor::State::holds_dependencies(
    ServedClient& client, const ServedVolume& volume, const Bundle& bundle,
    const SharedRegion& dependent, std::span<const Subscription> subscriptions) const noexcept {
  if (dependent.dependencies.empty()) return true;
  const auto earlier = find_lagging(dependent, subscriptions);
  const std::uint32_t first = earlier == dependent.lagging.end() ? subscriptions[0].first_update
                                                                 : earlier->last_current + 1;
  const auto is_recent = [&](const SharedRegion& shared, std::span<const Subscription> held) {
    if (is_current(shared, held)) return shared.last_current(updates) >= first;
    const auto lagging = find_lagging(shared, held);
    return lagging != shared.lagging.end() && lagging->last_current >= first;
  };
  for (std::size_t l = 0; l < volume.bundles.size(); ++l) {
    const Bundle& other = *volume.bundles[l];
    if (!bundle.depends_on(other)) continue;
    for (const std::uint32_t region : dependent.dependencies) {
      const auto held = client.subscriptions_of(volume.id(), l, other, region);
      if (!is_recent(other.regions[region], held)) return false;
    }
  }
  return true;
}

/// Gives a client the packets of its regions. One thread, after all regions are made. A client that
/// gets no packets holds what it held.
Status Distributor::State::hand_out_regions(ServedClient& client) noexcept {
  client.held_back = client.rate.slowed();
  if (client.suspended) return Status::ok;
  std::size_t packets = 0, places = 0;
  for_each_subscription(
      client, [&](const ServedVolume&, const Bundle& bundle, std::uint32_t, std::size_t place,
                  std::span<const Subscription> subscriptions, SharedRegion& shared) {
        places = place + 1;
        if (!takes_part(client, bundle, place, subscriptions)) return;
        packets += group_of(shared, subscriptions).packets.size();
      });
  const Status room = guarded([&]() -> Status {
    client.out.reserve(packets);
    return Status::ok;
  });
  if (room != Status::ok) return room;
  const double most =
      client.budget.bytes == 0 ? 1e18 : kBurst * static_cast<double>(client.budget.bytes);
  // If not all packets fit, each update begins with another region.
  const std::size_t start = client.rate.slowed() ? spread(updates, places) : 0;
  std::size_t turns = 0, bytes = 0, blocks = 0;
  for (const bool wrapped : {false, true}) {
    if (wrapped && start == 0) break;
    for_each_subscription(client, [&](const ServedVolume& volume, const Bundle& bundle,
                                      std::uint32_t region, std::size_t place,
                                      std::span<Subscription> subscriptions, SharedRegion& shared) {
      if ((place < start) != wrapped || !takes_part(client, bundle, place, subscriptions)) return;
      SubscriberGroup& subscribers = group_of(shared, subscriptions);
      // A turn without its keyframe counts when that comes.
      const bool own = client.rate.turn(bundle.turn(updates), place);
      const bool waits =
          bundle.is_stateful && subscribers.packets.empty() && !is_current(shared, subscriptions);
      const bool newly = waits && !std::exchange(subscriptions[0].owed, waits);
      if (!subscribers.packets.empty() || (own && !newly)) ++turns;
      if (subscribers.packets.empty()) return;
      std::size_t size = 0;
      for (const SharedPacket& one : subscribers.packets) size += one.packet->size();
      const bool full = bytes > 0 && static_cast<double>(bytes + size) > most;
      if (full || !holds_dependencies(client, volume, bundle, shared, subscriptions)) {
        client.held_back = true;
        return;
      }
      bytes += size;
      const auto tier = static_cast<std::uint8_t>(client.rate.tier(place));
      for (const SharedPacket& one : subscribers.packets) {
        client.out.push_back({{volume.id(), one.texture, region},
                              tier,
                              one.blocks,
                              one.sequence,
                              one.keyframe,
                              one.packet});
        blocks += one.blocks;
      }
      for (std::size_t i = 0; i < subscriptions.size(); ++i) {
        subscriptions[i].sequence = shared.streams[i].sequence();
        subscriptions[i].checksum = shared.streams[i].checksum();
        subscriptions[i].owed = false;
      }
      --subscribers.all;
    });
  }
  if (start > 0) {
    std::stable_sort(
        client.out.begin(), client.out.end(),
        [](const OutgoingPacket& a, const OutgoingPacket& b) { return a.stream < b.stream; });
  }
  client.rate.sent(turns, bytes, blocks);
  return Status::ok;
}

/// After an update: drops states that no client holds, states beyond kMaxLagging, all packets, and
/// the counts of subscribers.
void Distributor::State::forget_subscribers() noexcept {
  const auto fewer = [](const Lagging& a, const Lagging& b) {
    return a.subscribers.all < b.subscribers.all;
  };
  const auto nobody = [](const Lagging& one) { return one.subscribers.all == 0; };
  for_each_region([&](const ServedVolume&, const Bundle& bundle, SharedRegion& shared) {
    auto& lagging = shared.lagging;
    // No packet leads from an earlier state of a stateful encoder to a later one.
    if (bundle.is_stateful) lagging.clear();
    lagging.erase(std::remove_if(lagging.begin(), lagging.end(), nobody), lagging.end());
    // Drops the oldest of the states with fewest clients, which then get snapshots.
    if (lagging.size() > kMaxLagging) {
      lagging.erase(std::min_element(lagging.begin(), lagging.end(), fewer));
    }
    for (Lagging& one : lagging) one.subscribers = {};
    shared.up_to_date = shared.waiting = {};
  });
}

const StreamState* Distributor::State::held_of_region(ServedClient& client,
                                                      StreamId id) const noexcept {
  const auto subscriptions = find_subscriptions(client, id);
  if (subscriptions.empty()) return nullptr;
  const TexturePlace at = find(id.volume, id.texture);
  const SharedRegion& shared = at.bundle->regions[id.region];
  if (is_current(shared, subscriptions)) return &shared.streams[at.place].state();
  const auto lagging = find_lagging(shared, subscriptions);
  return lagging == shared.lagging.end() ? nullptr : &lagging->states[at.place];
}

}  // namespace gicodec
