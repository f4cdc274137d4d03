#include <gicodec/error_bound.h>
#include <gicodec/host.h>

#include "base/guard.h"
#include "base/text.h"
#include "bitstream/description.h"
#include "session/host_state.h"

#include <algorithm>
#include <cmath>

namespace gicodec {
namespace {

/// What clients are told of a texture: how far off it was before, and what is lost on the way.
float told_error(const BlockSet& set, std::size_t place, const StreamedTexture& streamed) {
  const NamedTexture& texture = set.textures[place];
  const bool exact = texture.threshold == Threshold::exact || place == set.presence;
  const float own = exact ? 0 : std::max(streamed.threshold, streamed.max_error);
  return both_errors(streamed.source_error, allows_error(texture.desc.record, own) ? own : 0);
}

}  // namespace

Peer* Host::State::find(PeerId peer) {
  const auto it = peers.find(peer);
  return it == peers.end() ? nullptr : it->second.get();
}

const Peer* Host::State::find_session(PeerId peer) const {
  const auto it = peers.find(peer);
  const bool found = it != peers.end() && it->second->session != nullptr;
  return found ? it->second.get() : nullptr;
}

void Host::State::event(HostEvent::Kind kind, const Peer& peer) {
  events.push_back({kind, peer.id, peer.session->client, Reason::left});
}

/// All of it or nothing.
Status Host::State::send(Peer& peer, const AnyMessage& message) {
  return guarded([&]() -> Status {
    Message bytes;
    const Status status = write_message(message, bytes);
    if (status == Status::ok) peer.messages.push_back(std::move(bytes));
    return status;
  });
}

void Host::State::end(Session& session) noexcept {
  static_cast<void>(server.disconnect(session.client));
  sessions.erase(session.client);
}

void Host::State::drop(Peer& peer, Reason reason) noexcept {
  if (peer.dropped) return;
  peer.dropped = true;
  // Nothing of what was made for it needs to go before the reason; without memory, nothing goes.
  peer.messages.clear();
  peer.in_flight.clear();
  if (reason != Reason::left) {
    static_cast<void>(guarded([&]() -> Status {
      return send(peer, Goodbye{reason, std::string(to_string(reason))});
    }));
  }
  const ClientId client = peer.session != nullptr ? peer.session->client : 0;
  peer.farewell = HostEvent{HostEvent::Kind::dropped, peer.id, client, reason};
  if (peer.session != nullptr) end(*std::exchange(peer.session, nullptr));
}

Host::Host(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Host::Host(Host&&) noexcept = default;
Host& Host::operator=(Host&&) noexcept = default;
Host::~Host() = default;

Result<Host> Host::create(Server&& server, const HostOptions& options) {
  return guarded([&]() -> Result<Host> {
    const bool times = options.messages_per_second > 0 && options.resyncs_per_second > 0 &&
                       options.hello_timeout > 0 && options.stall_timeout > 0 &&
                       options.linger >= 0 && options.interval >= 0;
    if (!times || options.max_peers == 0 || options.max_waiting == 0 ||
        options.max_in_flight == 0 || options.max_in_flight_bytes == 0 ||
        options.token.size() > kMaxToken || options.scene.name.size() > kMaxName ||
        !is_utf8(options.scene.name) || server.volumes() != 0) {
      return Status::invalid_argument;
    }
    Ticket ticket{};
    if (const Status status = draw(options, ticket); status != Status::ok) return status;
    std::uint64_t epoch = options.epoch;
    if (epoch == 0) {
      const Status status = draw(options, std::as_writable_bytes(std::span(&epoch, 1)));
      if (status != Status::ok) return status;
      if (epoch == 0) return Status::backend_failed;  // No source of randomness.
    }
    auto state = std::make_unique<State>(std::move(server), options);
    state->options.epoch = epoch;
    return Host(std::move(state));
  });
}

Result<std::uint16_t> Host::add_volume(std::string name, const VolumeDesc& volume,
                                       const VolumeGeometry& geometry,
                                       std::span<const StreamedTexture> textures) {
  return guarded([&]() -> Result<std::uint16_t> {
    if (!state_->sessions.empty() || name.size() > kMaxName || !is_utf8(name)) {
      return Status::invalid_argument;
    }
    DescribedVolume described{std::move(name), volume.kind, {}, geometry, {}, {}};
    described.region = state_->server.options().region;
    const Status status = write_volume_desc(volume, state_->options.kinds, described.description);
    if (status != Status::ok) return status;
    for (const BlockSet& set : volume.sets) {
      for (std::size_t place = 0; place < set.textures.size(); ++place) {
        const NamedTexture& texture = set.textures[place];
        const std::size_t id = described.textures.size();
        const float error = id < textures.size() ? told_error(set, place, textures[id]) : 0;
        described.textures.push_back({texture.name, texture.desc.layout, error});
      }
    }
    state_->subscribe_costs.reserve(state_->volumes.size() + 1);
    state_->volumes.push_back(std::move(described));
    const auto id = state_->server.add_volume(volume, geometry, textures);
    if (!id) {
      state_->volumes.pop_back();
      return id;
    }
    double blocks = 0;
    for (const BlockSet& set : volume.sets) {
      const std::uint32_t of_set = block_count(set.textures[0].desc);
      state_->largest_set = std::max(state_->largest_set, of_set);
      blocks += of_set;
    }
    const double cost = blocks / kBlocksOfAMessage;
    state_->subscribe_costs.push_back(cost);
    state_->message_burst += (1 + cost) * static_cast<double>(volume.sets.size());
    return id;
  });
}

Server& Host::server() noexcept { return state_->server; }

Result<PeerId> Host::connect(double now, std::string_view origin) {
  return guarded([&]() -> Result<PeerId> {
    const HostOptions& options = state_->options;
    if (!std::isfinite(now)) return Status::invalid_argument;
    if (state_->peers.size() >= options.max_peers) return Status::limit_exceeded;
    auto peer = std::make_unique<Peer>();
    peer->id = state_->next_peer++;
    if (!origin.empty()) peer->origin = std::hash<std::string_view>()(origin) | 1;
    peer->connected = peer->progress = now;
    peer->messages_left = {state_->message_burst, now};
    peer->resyncs_left = {kResyncBurst * options.resyncs_per_second, now};
    const PeerId id = peer->id;
    state_->peers.emplace(id, std::move(peer));
    state_->make_room_to_wait();
    return id;
  });
}

/// Who says nothing gives way to those who may say something.
void Host::State::make_room_to_wait() noexcept {
  Peer* oldest = nullptr;
  std::uint32_t waiting = 0;
  for (const auto& [id, peer] : peers) {
    if (peer->dropped || peer->session != nullptr) continue;
    ++waiting;
    if (oldest == nullptr) oldest = peer.get();
  }
  if (waiting > options.max_waiting) drop(*oldest, Reason::silent);
}

void Host::disconnect(PeerId peer, double now) {
  Peer* const found = state_->find(peer);
  if (found == nullptr) return;
  if (Session* session = found->session; session != nullptr) {
    session->peer = 0;
    session->lost = now;
    static_cast<void>(state_->server.suspend(session->client, true));
  }
  if (found->farewell) {
    static_cast<void>(guarded([&]() -> Status {
      state_->events.push_back(*found->farewell);
      return Status::ok;
    }));
  }
  state_->peers.erase(peer);
}

void Host::drop(PeerId peer, Reason reason) {
  if (Peer* const found = state_->find(peer); found != nullptr) state_->drop(*found, reason);
}

void Host::tick(double now) {
  static_cast<void>(guarded([&]() -> Status {
    const HostOptions& options = state_->options;
    for (const auto& [id, peer] : state_->peers) {
      if (peer->session == nullptr) {
        if (now - peer->connected > options.hello_timeout) state_->drop(*peer, Reason::silent);
      } else if (!peer->in_flight.empty() && now - peer->progress > options.stall_timeout) {
        state_->drop(*peer, Reason::stalled);
      }
    }
    for (auto it = state_->sessions.begin(); it != state_->sessions.end();) {
      Session& session = *(it++)->second;
      if (session.peer != 0 || now - session.lost <= options.linger) continue;
      state_->events.push_back({HostEvent::Kind::expired, 0, session.client, Reason::left});
      state_->end(session);
    }
    return Status::ok;
  }));
}

Status Host::update(double now, double time) {
  if (!std::isfinite(now) || !std::isfinite(time) ||
      state_->server.volumes() != state_->volumes.size()) {
    return Status::invalid_argument;
  }
  tick(now);
  state_->look_at_clock(now);
  state_->share_own_blocks();
  for (const auto& [id, peer] : state_->peers) {
    if (peer->session != nullptr) state_->look_after(*peer, now);
  }
  const std::uint64_t before = state_->server.updates();
  Status first = state_->server.update();
  if (state_->server.updates() == before) return first;
  for (const auto& [id, peer] : state_->peers) {
    if (peer->session == nullptr || peer->turn == Peer::Turn::none) continue;
    const Status status =
        guarded([&, to = peer.get()] { return state_->send_update(*to, now, time); });
    // Its streams went on without it.
    if (status != Status::ok) state_->drop(*peer, Reason::exhausted);
    if (first == Status::ok) first = status;
  }
  return first;
}

Status Host::State::send_update(Peer& peer, double now, double time) {
  Session& session = *peer.session;
  UpdateMessage message{peer.epoch, peer.number + 1, server.updates(), time, {}, {}, {}};
  InFlight sent{message.epoch, message.number, now, {}, {}};
  std::uint64_t blocks = 0;
  for (const OutgoingPacket& packet : server.packets(session.client)) {
    message.parts.push_back({packet.stream, packet.tier, *packet.packet});
    if (const auto info = peek(*packet.packet); info) {
      sent.packets.emplace_back(packet.stream, info->sequence);
    }
    session.streams.insert(packet.stream);
    blocks += packet.blocks;
  }
  if (options.proofs) {
    for (const StreamId stream : session.streams) {
      const auto hash = server.state_hash(session.client, stream);
      if (hash) message.proofs.push_back({stream, *hash});
    }
  }
  for (std::uint16_t volume = 0; volume < volumes.size(); ++volume) {
    message.scrolls.push_back(server.geometry(volume)->scroll);
  }
  sent.sent = {now,
               0,
               peer.pace.delivered(),
               peer.paced && server.held_back(session.client),
               !oldest_filled(peer).has_value(),
               peer.turn == Peer::Turn::empty};
  const bool reminder = peer.turn == Peer::Turn::reminder;
  if (!reminder) peer.in_flight.push_back(std::move(sent));
  if (const Status status = send(peer, message); status != Status::ok) return status;
  const std::uint64_t bytes = peer.messages.back().size();
  ++peer.number;
  if (reminder) {
    peer.reminded = now;
  } else {
    peer.in_flight.back().sent.bytes = bytes;
    peer.statistics.in_flight_bytes += bytes;
  }
  session.credit -= static_cast<double>(bytes);
  total_credit -= static_cast<double>(bytes);
  peer.statistics.bytes += bytes;
  peer.statistics.blocks += blocks;
  ++peer.statistics.updates;
  return Status::ok;
}

std::vector<Message> Host::take_messages(PeerId peer) {
  Peer* const found = state_->find(peer);
  return found == nullptr ? std::vector<Message>() : std::exchange(found->messages, {});
}

std::vector<HostEvent> Host::take_events() {
  // What there is no memory for is told the next time.
  static_cast<void>(guarded([&]() -> Status {
    for (const auto& [id, peer] : state_->peers) {
      if (!peer->farewell) continue;
      state_->events.push_back(*peer->farewell);
      peer->farewell.reset();
    }
    return Status::ok;
  }));
  return std::exchange(state_->events, {});
}

Result<std::vector<PeerId>> Host::peers() const {
  return guarded([&]() -> Result<std::vector<PeerId>> {
    std::vector<PeerId> ids;
    for (const auto& [id, peer] : state_->peers) {
      if (peer->session != nullptr) ids.push_back(id);
    }
    return ids;
  });
}

std::optional<ClientId> Host::client(PeerId peer) const {
  const Peer* const found = state_->find_session(peer);
  if (found == nullptr) return std::nullopt;
  return found->session->client;
}

std::optional<Viewpoint> Host::viewpoint(PeerId peer) const {
  const Peer* const found = state_->find_session(peer);
  return found == nullptr ? std::nullopt : found->session->viewpoint;
}

std::optional<PeerStatistics> Host::statistics(PeerId peer) const {
  const Peer* const found = state_->find(peer);
  if (found == nullptr || found->statistics.client == 0) return std::nullopt;
  PeerStatistics statistics = found->statistics;
  statistics.in_flight = static_cast<std::uint32_t>(found->in_flight.size());
  statistics.update_bytes = static_cast<std::uint64_t>(found->pace.bytes());
  return statistics;
}

std::vector<float> Host::take_latencies(PeerId peer) {
  Peer* const found = state_->find(peer);
  return found == nullptr ? std::vector<float>() : std::exchange(found->latencies, {});
}

std::size_t Host::memory() const noexcept {
  std::size_t bytes = state_->server.memory();
  for (const auto& [client, session] : state_->sessions) {
    if (const auto state = state_->server.state(session->client); state) bytes += state->memory;
  }
  for (const auto& [id, peer] : state_->peers) {
    bytes += sizeof(Peer);
    for (const Message& message : peer->messages) bytes += message.capacity();
  }
  return bytes;
}

}  // namespace gicodec
