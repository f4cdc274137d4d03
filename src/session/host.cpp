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

/// Updates of a texture that can be taken back, at least.
constexpr std::uint32_t kUnacknowledged = 32;

}  // namespace

Peer* Host::State::find(PeerId peer) {
  const auto it = peers.find(peer);
  return it == peers.end() ? nullptr : it->second.get();
}

const Peer* Host::State::find_session(PeerId peer) const noexcept {
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
    if (status == Status::ok) peer.messages.push_back({std::move(bytes)});
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
  peer.told = 0;
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

Result<Host> Host::create(const HostOptions& options) {
  return guarded([&]() -> Result<Host> {
    if (options.scene.name.size() > kMaxName || !is_utf8(options.scene.name)) {
      return Status::invalid_name;
    }
    const bool times = options.messages_per_second > 0 && options.resyncs_per_second > 0 &&
                       options.hello_timeout > 0 && options.stall_timeout > 0 &&
                       options.linger >= 0 && options.interval >= 0;
    if (!times || options.max_peers == 0 || options.max_waiting == 0 ||
        options.first_update_bytes < 2048 || options.max_in_flight == 0 ||
        options.max_in_flight_bytes == 0 || options.token.size() > kMaxToken) {
      return Status::invalid_argument;
    }
    // What is on its way can be taken back.
    auto server = Server::create({options.backend, options.settings, options.backends,
                                  options.threads, options.region, options.max_clients,
                                  std::max(options.max_in_flight, kUnacknowledged)});
    if (!server) return server.status();
    Ticket ticket{};
    if (const Status status = draw(options, ticket); status != Status::ok) return status;
    std::uint64_t epoch = options.epoch;
    if (epoch == 0) {
      const Status status = draw(options, std::as_writable_bytes(std::span(&epoch, 1)));
      if (status != Status::ok) return status;
      if (epoch == 0) return Status::backend_failed;  // No source of randomness.
    }
    auto state = std::make_unique<State>(*std::move(server), options);
    state->options.epoch = epoch;
    return Host(std::move(state));
  });
}

Result<PeerId> Host::connect(double now, std::string_view origin) {
  return guarded([&]() -> Result<PeerId> {
    const HostOptions& options = state_->options;
    if (!std::isfinite(now)) return Status::invalid_time;
    if (state_->peers.size() >= options.max_peers) return Status::limit_exceeded;
    auto peer = std::make_unique<Peer>(state_->options.first_update_bytes);
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

std::vector<OutgoingMessage> Host::take_messages(PeerId peer) {
  Peer* const found = state_->find(peer);
  if (found == nullptr) return {};
  found->told = 0;
  return std::exchange(found->messages, {});
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
  if (const auto state = state_->server.state(statistics.client); state) {
    statistics.owed = state->owed + state_->server.missing(statistics.client);
    statistics.oldest_owed = state->oldest_owed;
    statistics.memory = state_->server.memory_of(statistics.client);
  }
  return statistics;
}

std::vector<float> Host::take_latencies(PeerId peer) {
  Peer* const found = state_->find(peer);
  return found == nullptr ? std::vector<float>() : std::exchange(found->latencies, {});
}

std::size_t Host::memory() const noexcept {
  std::size_t bytes = state_->server.memory();
  for (const auto& [client, session] : state_->sessions) {
    bytes += state_->server.memory_of(session->client);
  }
  for (const auto& [id, peer] : state_->peers) {
    bytes += sizeof(Peer);
    for (const OutgoingMessage& message : peer->messages) {
      bytes += message.head.capacity();
      if (message.rest == nullptr) continue;
      bytes += message.rest->capacity() / static_cast<std::size_t>(message.rest.use_count());
    }
  }
  return bytes;
}

}  // namespace gicodec
