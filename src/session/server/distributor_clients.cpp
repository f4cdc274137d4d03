// The clients of a Distributor: which there are, what they see, what they hold.
#include "base/guard.h"
#include "session/server/distributor_state.h"

#include <algorithm>
#include <utility>

namespace gicodec {

ServedClient* Distributor::State::find(ClientId client) {
  const auto it = clients.find(client);
  return it == clients.end() ? nullptr : it->second.get();
}

UpdateStream* Distributor::State::find(ServedClient& client, StreamId id) {
  if (id.region != StreamId::kWholeVolume) return nullptr;
  const TexturePlace at = find(id.volume, id.texture);
  for (UnicastBundle& unicast : client.unicast) {
    if (unicast.bundle == at.bundle) return &unicast.streams[at.place];
  }
  return nullptr;
}

/// Adds a volume to a client's tables.
Status Distributor::State::add_volume_to(ServedClient& client, ServedVolume& volume) {
  const std::size_t id = volume.id(), places = std::max(volumes.size(), id + 1);
  client.backlog = {};
  client.visible.resize(places);
  client.visible[id].resize(volume.desc.groups.size());
  if (options.all_visible) {
    for (std::size_t group = 0; group < volume.desc.groups.size(); ++group) {
      client.visible[id][group].assign(volume.blocks(group), 1);
    }
  }
  client.interest.resize(places);
  client.subscriptions.resize(places);
  for (const auto& bundle : volume.bundles) {
    if (client.delivery == Delivery::shared) {
      client.subscriptions[id].emplace_back(bundle->regions.size() * bundle->textures.size());
      continue;
    }
    client.unicast.push_back({&volume, bundle.get(), {}, {}});
    UnicastBundle& unicast = client.unicast.back();
    unicast.pending_since.resize(block_count(bundle->desc()));
    for (const auto& texture : bundle->textures) {
      unicast.streams.emplace_back(
          texture->history, texture->history.desc(), std::vector<std::uint32_t>(),
          PacketChain{texture->options.backend->id(), texture->id}, options.max_unacknowledged);
    }
    const Status status = make_encoders(*bundle, unicast.streams, unicast.encoders);
    if (status != Status::ok) return status;
  }
  if (client.delivery == Delivery::shared) set_joins(client, volume);
  return Status::ok;
}

/// Undoes add_volume_to(), whether it was complete or not.
void Distributor::State::drop_volume_of(ServedClient& client, const ServedVolume& volume) noexcept {
  client.backlog = {};
  const auto is_its = [&](const UnicastBundle& unicast) { return unicast.volume == &volume; };
  client.unicast.erase(std::remove_if(client.unicast.begin(), client.unicast.end(), is_its),
                       client.unicast.end());
  const std::size_t id = volume.id();
  if (id < client.visible.size()) client.visible[id].clear();
  if (id < client.interest.size()) client.interest[id].reset();
  if (id < client.subscriptions.size()) client.subscriptions[id].clear();
}

bool Distributor::State::any_unicast() const noexcept {
  return std::any_of(clients.begin(), clients.end(),
                     [](const auto& entry) { return entry.second->delivery == Delivery::unicast; });
}

Result<ClientId> Distributor::connect(Delivery delivery, Budget budget) {
  return guarded([&]() -> Result<ClientId> {
    if (state_->clients.size() >= state_->options.max_clients) return Status::limit_exceeded;
    const bool lossy = std::any_of(state_->volumes.begin(), state_->volumes.end(),
                                   [](const auto& volume) { return volume->is_lossy(); });
    if (delivery == Delivery::unicast && lossy) return Status::unsupported_backend;
    const ClientId id = state_->next_client;
    auto client = std::make_unique<ServedClient>(id);
    client->delivery = delivery;
    client->budget = budget;
    for (const auto& volume : state_->volumes) {
      if (volume->removed()) continue;
      const Status status = state_->add_volume_to(*client, *volume);
      if (status != Status::ok) return status;
    }
    state_->clients.emplace(id, std::move(client));
    ++state_->next_client;
    return id;
  });
}

Status Distributor::disconnect(ClientId client) {
  return state_->clients.erase(client) == 1 ? Status::ok : Status::unknown_connection;
}

Status Distributor::suspend(ClientId client, bool suspended) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::unknown_connection;
  found->suspended = suspended;
  return Status::ok;
}

Status Distributor::set_budget(ClientId client, Budget budget) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::unknown_connection;
  found->budget = budget;
  return Status::ok;
}

Status Distributor::set_visible(ClientId client, std::uint16_t volume,
                                std::span<const std::uint8_t> visible, std::uint8_t group) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::unknown_connection;
  const Status fits = state_->check_mask(volume, group, visible);
  if (fits != Status::ok) return fits;
  ServedVolume& served = *state_->volumes[volume];
  return guarded([&]() -> Status {
    found->visible[volume][group].assign(visible.begin(), visible.end());
    found->interest[volume].reset();
    if (found->delivery == Delivery::shared) state_->set_joins(*found, served);
    return Status::ok;
  });
}

Status Distributor::acknowledge(ClientId client, StreamId stream, std::uint32_t sequence) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::unknown_connection;
  UpdateStream* const unicast = state_->find(*found, stream);
  if (unicast == nullptr || sequence > unicast->sequence()) return Status::invalid_argument;
  unicast->acknowledge(sequence);
  return Status::ok;
}

Status Distributor::resume(ClientId client, StreamId stream, std::uint32_t sequence,
                           std::uint32_t checksum) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::unknown_connection;
  if (found->delivery == Delivery::shared) {
    const auto subscriptions = state_->find_subscriptions(*found, stream);
    if (subscriptions.empty()) return Status::invalid_argument;
    Subscription& subscription = subscriptions[state_->find(stream.volume, stream.texture).place];
    subscription = {subscription.subscribed, subscription.owed, sequence, checksum,
                    subscription.first_update};
    return Status::ok;
  }
  UpdateStream* const unicast = state_->find(*found, stream);
  if (unicast == nullptr) return Status::invalid_argument;
  // A stateful backend cannot go back to an earlier state.
  const bool is_stateful = state_->find(stream.volume, stream.texture).bundle->is_stateful;
  if (is_stateful && sequence != unicast->sequence()) {
    unicast->request_keyframe();
  } else {
    static_cast<void>(unicast->resume(sequence, checksum));
  }
  return Status::ok;
}

Result<std::uint64_t> Distributor::state_hash(ClientId client, StreamId stream) const {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::unknown_connection;
  const StreamState* held = nullptr;
  if (found->delivery == Delivery::shared) {
    held = state_->held_of_region(*found, stream);
  } else if (const UpdateStream* unicast = state_->find(*found, stream);
             unicast != nullptr && !unicast->keyframe_next()) {
    held = &unicast->state();
  }
  // It is not known what a client holds before its keyframe.
  if (held == nullptr) return Status::invalid_argument;
  return held->hash();
}

std::span<const OutgoingPacket> Distributor::packets(ClientId client) const noexcept {
  const ServedClient* const found = state_->find(client);
  return found == nullptr ? std::span<const OutgoingPacket>() : found->out;
}

bool Distributor::has_pending(ClientId client) const noexcept {
  const ServedClient* const found = state_->find(client);
  return found != nullptr && found->has_pending;
}

bool Distributor::held_back(ClientId client) const noexcept {
  const ServedClient* const found = state_->find(client);
  return found != nullptr && found->held_back;
}

Result<ClientState> Distributor::state(ClientId client) const {
  const ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::unknown_connection;
  ClientState totals = found->totals;
  if (state_->chooses_presets()) {
    const bool unicast = found->delivery == Delivery::unicast;
    totals.preset = kPresets[(unicast ? found->preset : state_->shared_preset).preset()];
  }
  const auto updates = static_cast<std::uint32_t>(state_->updates);
  for (const UnicastBundle& unicast : found->unicast) {
    // pending_since is not up to date for blocks that the last update did not examine.
    const BlockMask* const interest = unicast.bundle->due && found->knows_interest(unicast)
                                          ? &found->interest_in(unicast)
                                          : nullptr;
    for (std::uint32_t block = 0; block < unicast.pending_since.size(); ++block) {
      const std::uint32_t since = unicast.pending_since[block];
      if (interest != nullptr ? !is_pending(unicast, *interest, block) : since == 0) continue;
      ++totals.pending;
      if (since != 0) totals.oldest_pending = std::max(totals.oldest_pending, updates - since);
    }
  }
  return totals;
}

std::size_t Distributor::memory_of(ClientId client) const noexcept {
  const ServedClient* const found = state_->find(client);
  if (found == nullptr) return 0;
  std::size_t bytes = sizeof *found + found->backlog.due.capacity() +
                      found->backlog.oldest.capacity() * sizeof(Backlog::Place);
  for (const auto& masks : found->visible) {
    for (const BlockMask& mask : masks) bytes += mask.capacity();
  }
  for (const auto& masks : found->interest) {
    if (masks == nullptr) continue;
    for (const BlockMask& mask : *masks) bytes += mask.capacity();
  }
  for (const auto& bundles : found->subscriptions) {
    for (const auto& subscriptions : bundles)
      bytes += subscriptions.capacity() * sizeof(Subscription);
  }
  for (const UnicastBundle& unicast : found->unicast) {
    bytes += sizeof unicast + unicast.pending_since.capacity() * sizeof unicast.pending_since[0];
    for (const UpdateStream& stream : unicast.streams) bytes += sizeof stream + stream.memory();
  }
  return bytes;
}

/// Subscribes the client to the regions with a visible block, to all regions of bundles that blocks
/// of subscribed regions depend on, and to no others.
void Distributor::State::set_joins(ServedClient& client, const ServedVolume& volume) noexcept {
  for (std::size_t l = volume.bundles.size(); l-- > 0;) {
    const Bundle& bundle = *volume.bundles[l];
    const BlockMask& visible = client.visible[volume.id()][bundle.group_id];
    bool needed = false;
    for (std::size_t later = l + 1; later < volume.bundles.size(); ++later) {
      const auto& subscriptions = client.subscriptions[volume.id()][later];
      needed =
          needed ||
          (volume.bundles[later]->depends_on(bundle) &&
           std::any_of(subscriptions.begin(), subscriptions.end(),
                       [](const Subscription& subscription) { return subscription.subscribed; }));
    }
    const auto is_seen = [&](std::uint32_t block) { return visible[block] != 0; };
    for (std::uint32_t region = 0; region < bundle.regions.size(); ++region) {
      const auto& blocks = bundle.region_blocks[region];
      const bool seen = !visible.empty() && std::any_of(blocks.begin(), blocks.end(), is_seen);
      for (Subscription& subscription : client.subscriptions_of(volume.id(), l, bundle, region)) {
        if (!subscription.subscribed)
          subscription.first_update = static_cast<std::uint32_t>(updates) + 1;
        subscription.subscribed = needed || seen;
      }
    }
  }
}

std::span<Subscription> Distributor::State::find_subscriptions(ServedClient& client,
                                                               StreamId id) const noexcept {
  const TexturePlace at = find(id.volume, id.texture);
  if (at.bundle == nullptr || id.region >= at.bundle->regions.size()) return {};
  return client.subscriptions_of(id.volume, at.bundle_id, *at.bundle, id.region);
}

}  // namespace gicodec
