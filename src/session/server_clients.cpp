// What a Server is asked about its clients: who is there, what they see, what they hold.
#include "base/guard.h"
#include "session/server_state.h"

#include <algorithm>
#include <utility>

namespace gicodec {

ServedClient* Server::State::find(ClientId client) {
  const auto it = clients.find(client);
  return it == clients.end() ? nullptr : it->second.get();
}

OwnStream* Server::State::find(ServedClient& client, StreamId id) {
  const auto same = [&](const OwnStream& own) {
    return own.volume->id == id.volume && own.texture->id == id.texture;
  };
  if (id.chunk != StreamId::kWholeVolume) return nullptr;
  const auto it = std::ranges::find_if(client.own, same);
  return it == client.own.end() ? nullptr : &*it;
}

/// Room for a volume in a client's tables.
Status Server::State::add_volume_to(ServedClient& client, ServedVolume& volume) {
  client.visible.resize(volumes.size());
  client.joins.resize(volumes.size());
  if (client.delivery == Delivery::shared) {
    client.joins[volume.id].assign(volume.chunks.chunks() * volume.textures.size(), Join());
    return Status::ok;
  }
  for (const auto& texture : volume.textures) {
    const TextureDesc& desc = texture->options.desc;
    std::unique_ptr<BackendEncoder> own;
    if (remembers) {
      auto encoder = backend->make_encoder(desc, options.settings);
      if (!encoder) return encoder.status();
      own = *std::move(encoder);
    }
    client.own.push_back(
        {&volume, texture.get(),
         UpdateStream(texture->history, desc, {}, PacketChain{backend->id(), texture->id},
                      options.max_unacknowledged),
         std::vector<std::uint32_t>(probe_count(desc)), std::move(own)});
  }
  return Status::ok;
}

/// Undoes add_volume_to() for the last volume, whether it was complete or not.
void Server::State::drop_last_volume_of(ServedClient& client) noexcept {
  const auto* const last = volumes.back().get();
  while (!client.own.empty() && client.own.back().volume == last) client.own.pop_back();
  client.visible.resize(std::min(client.visible.size(), volumes.size() - 1));
  client.joins.resize(std::min(client.joins.size(), volumes.size() - 1));
}

bool Server::State::any_shared() const noexcept {
  return std::ranges::any_of(
      clients, [](const auto& entry) { return entry.second->delivery == Delivery::shared; });
}

Result<ClientId> Server::connect(Delivery delivery, Budget budget) {
  return guarded([&]() -> Result<ClientId> {
    if (state_->clients.size() >= state_->options.max_clients) return Status::limit_exceeded;
    if (delivery == Delivery::shared && state_->remembers) return Status::unsupported_backend;
    const ClientId id = state_->next_client;
    auto client = std::make_unique<ServedClient>(id);
    client->delivery = delivery;
    client->budget = budget;
    for (const auto& volume : state_->volumes) {
      const Status status = state_->add_volume_to(*client, *volume);
      if (status != Status::ok) return status;
    }
    state_->clients.emplace(id, std::move(client));
    ++state_->next_client;
    return id;
  });
}

Status Server::disconnect(ClientId client) {
  return state_->clients.erase(client) == 1 ? Status::ok : Status::invalid_argument;
}

Status Server::suspend(ClientId client, bool suspended) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::invalid_argument;
  found->suspended = suspended;
  return Status::ok;
}

Status Server::set_budget(ClientId client, Budget budget) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::invalid_argument;
  found->budget = budget;
  return Status::ok;
}

Status Server::set_visible(ClientId client, std::uint16_t volume,
                           std::span<const std::uint8_t> visible) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr || volume >= state_->volumes.size()) return Status::invalid_argument;
  ServedVolume& served = *state_->volumes[volume];
  if (!visible.empty() && visible.size() != probe_count(served.textures[0]->options.desc)) {
    return Status::invalid_argument;
  }
  return guarded([&]() -> Status {
    found->visible[volume].assign(visible.begin(), visible.end());
    if (found->delivery == Delivery::shared) state_->set_joins(*found, served);
    return Status::ok;
  });
}

Status Server::acknowledge(ClientId client, StreamId stream, std::uint32_t sequence) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::invalid_argument;
  OwnStream* const own = state_->find(*found, stream);
  if (own == nullptr || sequence > own->stream.sequence()) return Status::invalid_argument;
  own->stream.acknowledge(sequence);
  return Status::ok;
}

Status Server::resume(ClientId client, StreamId stream, std::uint32_t sequence,
                      std::uint32_t checksum) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::invalid_argument;
  if (found->delivery == Delivery::shared) {
    return state_->resume_chunk(*found, stream, sequence, checksum);
  }
  OwnStream* const own = state_->find(*found, stream);
  if (own == nullptr) return Status::invalid_argument;
  // What a backend remembers cannot be taken back.
  if (state_->remembers && sequence != own->stream.sequence()) {
    own->stream.request_keyframe();
  } else {
    static_cast<void>(own->stream.resume(sequence, checksum));
  }
  return Status::ok;
}

Result<std::uint64_t> Server::state_hash(ClientId client, StreamId stream) const {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::invalid_argument;
  const StreamState* held = nullptr;
  if (found->delivery == Delivery::shared) {
    held = state_->held_of_chunk(*found, stream);
  } else if (const OwnStream* own = state_->find(*found, stream);
             own != nullptr && !own->stream.keyframe_next()) {
    held = &own->stream.state();
  }
  // Before its keyframe it is not known what a client holds.
  if (held == nullptr) return Status::invalid_argument;
  return held->hash();
}

std::span<const OutgoingPacket> Server::packets(ClientId client) const noexcept {
  const ServedClient* const found = state_->find(client);
  return found == nullptr ? std::span<const OutgoingPacket>() : found->out;
}

bool Server::held_back(ClientId client) const noexcept {
  const ServedClient* const found = state_->find(client);
  return found != nullptr && found->held_back;
}

Result<ClientState> Server::state(ClientId client) const {
  const ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::invalid_argument;
  ClientState totals = found->totals;
  totals.memory = sizeof(ServedClient);
  for (const ProbeMask& mask : found->visible) totals.memory += mask.capacity();
  for (const auto& joins : found->joins) totals.memory += joins.capacity() * sizeof(Join);
  for (const OwnStream& own : found->own) {
    totals.memory += sizeof own + own.stream.memory() + own.owed_since.capacity() * 4;
    for (const std::uint32_t since : own.owed_since) {
      if (since == 0) continue;
      ++totals.owed;
      totals.oldest_owed =
          std::max(totals.oldest_owed, static_cast<std::uint32_t>(state_->updates) - since);
    }
  }
  return totals;
}

}  // namespace gicodec
