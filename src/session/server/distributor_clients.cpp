// What a Distributor is asked about its clients: who is there, what they see, what they hold.
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
  for (OwnLot& own : client.own) {
    if (own.lot == at.lot) return &own.streams[at.place];
  }
  return nullptr;
}

/// Room for a volume in a client's tables.
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
  client.wanted.resize(places);
  client.joins.resize(places);
  for (const auto& lot : volume.lots) {
    if (client.delivery == Delivery::shared) {
      client.joins[id].emplace_back(lot->regions.size() * lot->textures.size());
      continue;
    }
    client.own.push_back({&volume, lot.get(), {}, {}, {}});
    OwnLot& own = client.own.back();
    own.owed_since.resize(block_count(lot->desc()));
    for (const auto& texture : lot->textures) {
      const TextureDesc& desc = texture->history.desc();
      own.streams.emplace_back(texture->history, desc, std::vector<std::uint32_t>(),
                               PacketChain{backend->id(), texture->id}, options.max_unacknowledged);
      if (!remembers) continue;
      auto encoder = backend->make_encoder(desc, options.settings);
      if (!encoder) return encoder.status();
      own.encoders.push_back(*std::move(encoder));
    }
  }
  if (client.delivery == Delivery::shared) set_joins(client, volume);
  return Status::ok;
}

/// Undoes add_volume_to(), whether it was complete or not.
void Distributor::State::drop_volume_of(ServedClient& client, const ServedVolume& volume) noexcept {
  client.backlog = {};
  const auto is_its = [&](const OwnLot& own) { return own.volume == &volume; };
  client.own.erase(std::remove_if(client.own.begin(), client.own.end(), is_its), client.own.end());
  const std::size_t id = volume.id();
  if (id < client.visible.size()) client.visible[id].clear();
  if (id < client.wanted.size()) client.wanted[id].reset();
  if (id < client.joins.size()) client.joins[id].clear();
}

bool Distributor::State::any_shared() const noexcept {
  return std::any_of(clients.begin(), clients.end(),
                     [](const auto& entry) { return entry.second->delivery == Delivery::shared; });
}

Result<ClientId> Distributor::connect(Delivery delivery, Budget budget) {
  return guarded([&]() -> Result<ClientId> {
    if (state_->clients.size() >= state_->options.max_clients) return Status::limit_exceeded;
    if (delivery == Delivery::shared && state_->remembers) return Status::unsupported_backend;
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
    found->wanted[volume].reset();
    if (found->delivery == Delivery::shared) state_->set_joins(*found, served);
    return Status::ok;
  });
}

Status Distributor::acknowledge(ClientId client, StreamId stream, std::uint32_t sequence) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::unknown_connection;
  UpdateStream* const own = state_->find(*found, stream);
  if (own == nullptr || sequence > own->sequence()) return Status::invalid_argument;
  own->acknowledge(sequence);
  return Status::ok;
}

Status Distributor::resume(ClientId client, StreamId stream, std::uint32_t sequence,
                           std::uint32_t checksum) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::unknown_connection;
  if (found->delivery == Delivery::shared) {
    const auto joins = state_->find_joins(*found, stream);
    if (joins.empty()) return Status::invalid_argument;
    Join& join = joins[state_->find(stream.volume, stream.texture).place];
    join = {join.subscribed, sequence, checksum, join.since};
    return Status::ok;
  }
  UpdateStream* const own = state_->find(*found, stream);
  if (own == nullptr) return Status::invalid_argument;
  // What a backend remembers cannot be taken back.
  if (state_->remembers && sequence != own->sequence()) {
    own->request_keyframe();
  } else {
    static_cast<void>(own->resume(sequence, checksum));
  }
  return Status::ok;
}

Result<std::uint64_t> Distributor::state_hash(ClientId client, StreamId stream) const {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::unknown_connection;
  const StreamState* held = nullptr;
  if (found->delivery == Delivery::shared) {
    held = state_->held_of_region(*found, stream);
  } else if (const UpdateStream* own = state_->find(*found, stream);
             own != nullptr && !own->keyframe_next()) {
    held = &own->state();
  }
  // Before its keyframe it is not known what a client holds.
  if (held == nullptr) return Status::invalid_argument;
  return held->hash();
}

std::span<const OutgoingPacket> Distributor::packets(ClientId client) const noexcept {
  const ServedClient* const found = state_->find(client);
  return found == nullptr ? std::span<const OutgoingPacket>() : found->out;
}

bool Distributor::owes(ClientId client) const noexcept {
  const ServedClient* const found = state_->find(client);
  return found != nullptr && found->owed;
}

bool Distributor::held_back(ClientId client) const noexcept {
  const ServedClient* const found = state_->find(client);
  return found != nullptr && found->held_back;
}

Result<ClientState> Distributor::state(ClientId client) const {
  const ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::unknown_connection;
  ClientState totals = found->totals;
  const auto updates = static_cast<std::uint32_t>(state_->updates);
  for (const OwnLot& own : found->own) {
    // Not all is looked at in each update.
    const BlockMask* const wanted =
        own.lot->due && found->knows_wanted(own) ? &found->wants(own) : nullptr;
    for (std::uint32_t block = 0; block < own.owed_since.size(); ++block) {
      const std::uint32_t since = own.owed_since[block];
      if (wanted != nullptr ? !is_owed(own, *wanted, block) : since == 0) continue;
      ++totals.owed;
      if (since != 0) totals.oldest_owed = std::max(totals.oldest_owed, updates - since);
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
  for (const auto& masks : found->wanted) {
    if (masks == nullptr) continue;
    for (const BlockMask& mask : *masks) bytes += mask.capacity();
  }
  for (const auto& lots : found->joins) {
    for (const auto& joins : lots) bytes += joins.capacity() * sizeof(Join);
  }
  for (const OwnLot& own : found->own) {
    bytes += sizeof own + own.owed_since.capacity() * sizeof own.owed_since[0];
    for (const UpdateStream& stream : own.streams) bytes += sizeof stream + stream.memory();
  }
  return bytes;
}

/// Subscribes to the regions of which the client sees a block, to all of a lot whose blocks are
/// named by those of such regions, and to no others.
void Distributor::State::set_joins(ServedClient& client, const ServedVolume& volume) noexcept {
  for (std::size_t l = volume.lots.size(); l-- > 0;) {
    const Lot& lot = *volume.lots[l];
    const BlockMask& visible = client.visible[volume.id()][lot.group_id];
    bool named = false;
    for (std::size_t later = l + 1; later < volume.lots.size(); ++later) {
      const auto& joins = client.joins[volume.id()][later];
      named = named || (volume.lots[later]->names(lot) &&
                        std::any_of(joins.begin(), joins.end(),
                                    [](const Join& join) { return join.subscribed; }));
    }
    const auto is_seen = [&](std::uint32_t block) { return visible[block] != 0; };
    for (std::uint32_t region = 0; region < lot.regions.size(); ++region) {
      const auto& blocks = lot.region_blocks[region];
      const bool seen = !visible.empty() && std::any_of(blocks.begin(), blocks.end(), is_seen);
      for (Join& join : client.joins_of(volume.id(), l, lot, region)) {
        if (!join.subscribed) join.since = static_cast<std::uint32_t>(updates) + 1;
        join.subscribed = named || seen;
      }
    }
  }
}

std::span<Join> Distributor::State::find_joins(ServedClient& client, StreamId id) const noexcept {
  const TexturePlace at = find(id.volume, id.texture);
  if (at.lot == nullptr || id.region >= at.lot->regions.size()) return {};
  return client.joins_of(id.volume, at.lot_id, *at.lot, id.region);
}

}  // namespace gicodec
