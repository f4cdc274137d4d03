// The volumes of a Server: their descriptions, and the messages when they come and go.
#include <gicodec/error_bound.h>

#include "base/guard.h"
#include "base/text.h"
#include "bitstream/description.h"
#include "session/server/server_state.h"

#include <algorithm>

namespace gicodec {
namespace {

/// The error of a texture at clients: that of the published records and of streaming together.
float error_at_clients(const TextureGroup& group, std::size_t place,
                       const StreamedTexture& streamed) {
  const NamedTexture& texture = group.textures[place];
  const bool exact = texture.threshold == Threshold::exact || place == group.presence;
  const float lost = exact ? 0 : std::max(streamed.threshold, streamed.max_error);
  return both_errors(streamed.source_error, allows_error(texture.desc.record, lost) ? lost : 0);
}

}  // namespace

double subscribe_cost(const ServedVolume& volume) noexcept {
  double blocks = 0;
  for (std::size_t group = 0; group < volume.desc.groups.size(); ++group)
    blocks += volume.blocks(group);
  return blocks / kBlocksOfAMessage;
}

/// Messages that a Subscribe to every group of a volume counts as.
static double burst_of(const ServedVolume& volume) noexcept {
  return (1 + subscribe_cost(volume)) * static_cast<double>(volume.desc.groups.size());
}

Result<DescribedVolume> Server::State::describe(std::string name, const VolumeDesc& volume,
                                                std::span<const StreamedTexture> textures) const {
  if (name.size() > kMaxName || !is_utf8(name)) return Status::invalid_name;
  const auto streamed = by_texture(volume, textures);
  if (!streamed) return streamed.status();
  DescribedVolume described;
  described.name = std::move(name);
  described.kind = volume.kind;
  described.added = generation + 1;
  const Status status = write_volume_desc(volume, options.kinds, described.description);
  if (status != Status::ok) return status;
  for (const TextureGroup& group : volume.groups) {
    for (std::size_t place = 0; place < group.textures.size(); ++place) {
      const NamedTexture& texture = group.textures[place];
      const float error = error_at_clients(group, place, (*streamed)[described.textures.size()]);
      described.textures.push_back({texture.name, texture.desc.layout, error});
    }
  }
  return described;
}

/// All of it or nothing.
Result<std::uint16_t> Server::add_volume(std::string name, const VolumeDesc& volume,
                                         const VolumeGeometry& geometry,
                                         std::span<const StreamedTexture> textures) {
  return guarded([&]() -> Result<std::uint16_t> {
    State& state = *state_;
    if (state.generation == UINT32_MAX) return Status::limit_exceeded;
    auto described = state.describe(std::move(name), volume, textures);
    if (!described) return described.status();
    const auto id = state.distributor.add_volume(volume, geometry, textures, *std::move(described));
    if (!id) return id;
    // From here on nothing can fail.
    const ServedVolume& added = *state.distributor.table()[*id];
    for (std::size_t group = 0; group < added.desc.groups.size(); ++group) {
      state.largest_group = std::max(state.largest_group, added.blocks(group));
    }
    state.message_burst += burst_of(added);
    ++state.generation;
    state.send_volumes_to_all();
    return id;
  });
}

Status Server::remove_volume(std::uint16_t volume) {
  State& state = *state_;
  if (state.generation == UINT32_MAX) return Status::limit_exceeded;
  const auto table = state.distributor.table();
  const double burst = volume < table.size() ? burst_of(*table[volume]) : 0;
  const Status removed = state.distributor.remove_volume(volume, state.generation + 1);
  if (removed != Status::ok) return removed;
  ++state.generation;
  state.message_burst -= burst;
  // Removes its streams from all sessions.
  for (const auto& [client, session] : state.sessions) {
    std::erase_if(session->streams, [&](const StreamId& id) { return id.volume == volume; });
  }
  for (const auto& [id, connection] : state.connections) {
    for (InFlight& update : connection->in_flight) {
      std::erase_if(update.packets,
                    [&](const auto& packet) { return packet.first.volume == volume; });
    }
  }
  state.send_volumes_to_all();
  return Status::ok;
}

std::vector<DescribedVolume> Server::State::described_now() const {
  std::vector<DescribedVolume> list;
  for (const auto& volume : distributor.table()) {
    if (!volume->removed()) list.push_back(volume->described);
  }
  return list;
}

/// Drops clients that cannot get the list: they could not apply the next update.
void Server::State::send_volumes_to_all() noexcept {
  for (const auto& [id, connection] : connections) {
    if (connection->session != nullptr) send_volumes(*connection);
  }
}

void Server::State::send_volumes(Connection& connection) noexcept {
  const Status sent = guarded([&]() -> Status {
    // Of consecutive lists only the last is needed.
    const bool repeated =
        connection.volumes_sent > 0 && connection.volumes_sent == connection.messages.size();
    const Status status = send(connection, Volumes{generation, described_now()});
    if (status != Status::ok) return status;
    if (repeated) connection.messages.erase(connection.messages.end() - 2);
    connection.volumes_sent = connection.messages.size();
    return Status::ok;
  });
  if (sent != Status::ok) drop(connection, Reason::exhausted);
}

Status Server::publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view) {
  return state_->distributor.publish(volume, texture, view);
}

Status Server::publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view,
                       std::span<const std::uint32_t> blocks) {
  return state_->distributor.publish(volume, texture, view, blocks);
}

Status Server::scroll(std::uint16_t volume, const Scroll& scroll) {
  return state_->distributor.scroll(volume, scroll);
}

std::size_t Server::volumes() const noexcept { return state_->distributor.volumes(); }

Result<VolumeGeometry> Server::geometry(std::uint16_t volume) const noexcept {
  return state_->distributor.geometry(volume);
}

Status Server::set_active(std::uint16_t volume, std::span<const std::uint8_t> active,
                          std::uint8_t group) {
  return state_->distributor.set_active(volume, active, group);
}

Status Server::set_visible(ConnectionId connection, std::uint16_t volume,
                           std::span<const std::uint8_t> visible, std::uint8_t group) {
  const Connection* const found = state_->find_session(connection);
  if (found == nullptr) return Status::unknown_connection;
  return state_->distributor.set_visible(found->session->client, volume, visible, group);
}

std::span<const OutgoingPacket> Server::packets(ConnectionId connection) const noexcept {
  const Connection* const found = state_->find_session(connection);
  return found == nullptr ? std::span<const OutgoingPacket>()
                          : state_->distributor.packets(found->session->client);
}

std::uint64_t Server::updates() const noexcept { return state_->distributor.updates(); }
WrittenBlocks Server::written() const noexcept { return state_->distributor.written(); }

}  // namespace gicodec
