#include <gicodec/error_bound.h>
#include <gicodec/server.h>

#include "base/guard.h"
#include "base/text.h"
#include "bitstream/description.h"
#include "session/server/server_state.h"

#include <algorithm>
#include <cmath>

namespace gicodec {
namespace {

/// Packets of a texture that can be reverted.
std::uint32_t max_unacknowledged(std::uint32_t updates_in_flight) noexcept {
  // Of each update two, if blocks moved.
  constexpr std::uint32_t kPackets = 2, kMin = 48;
  return std::max(kMin, std::min(updates_in_flight, UINT32_MAX / kPackets) * kPackets);
}

}  // namespace

Connection* Server::State::find(ConnectionId connection) {
  const auto it = connections.find(connection);
  return it == connections.end() ? nullptr : it->second.get();
}

const Connection* Server::State::find_session(ConnectionId connection) const noexcept {
  const auto it = connections.find(connection);
  const bool found = it != connections.end() && it->second->session != nullptr;
  return found ? it->second.get() : nullptr;
}

void Server::State::tell(const ServerEvent& event) {
  constexpr std::size_t kMost = 1 << 16;
  if (events.size() >= kMost) {  // nobody takes them
    events.erase(events.begin(), events.begin() + kMost / 2);
  }
  events.push_back(event);
}

void Server::State::event(ServerEvent::Type kind, const Connection& connection) {
  tell({kind, connection.id, connection.session->client, Reason::left});
}

/// All of it or nothing.
Status Server::State::send(Connection& connection, const AnyMessage& message) {
  return guarded([&]() -> Status {
    Message bytes;
    const Status status = write_message(message, bytes);
    if (status == Status::ok) connection.messages.push_back({std::move(bytes)});
    return status;
  });
}

void Server::State::end(Session& session) noexcept {
  static_cast<void>(distributor.disconnect(session.client));
  sessions.erase(session.client);
}

void Server::State::drop(Connection& connection, Reason reason) noexcept {
  if (connection.dropped) return;
  connection.dropped = true;
  // The client needs only the reason; without memory it gets nothing.
  connection.messages.clear();
  connection.volumes_sent = 0;
  connection.in_flight.clear();
  if (reason != Reason::left) {
    static_cast<void>(guarded([&]() -> Status {
      return send(connection, Goodbye{reason, std::string(to_string(reason))});
    }));
  }
  const ClientId client = connection.session != nullptr ? connection.session->client : 0;
  connection.farewell = ServerEvent{ServerEvent::Type::dropped, connection.id, client, reason};
  if (connection.session != nullptr) end(*std::exchange(connection.session, nullptr));
}

Server::Server(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Server::Server(Server&&) noexcept = default;
Server& Server::operator=(Server&&) noexcept = default;
Server::~Server() = default;

Result<Server> Server::create(const ServerOptions& options) {
  return guarded([&]() -> Result<Server> {
    if (options.scene.name.size() > kMaxName || !is_utf8(options.scene.name)) {
      return Status::invalid_name;
    }
    const ServerLimits& limits = options.limits;
    const ServerTimeouts& timeouts = options.timeouts;
    const bool times = limits.messages_per_second > 0 && limits.resyncs_per_second > 0 &&
                       timeouts.hello > 0 && timeouts.stall > 0 && timeouts.linger >= 0 &&
                       options.interval >= 0;
    if (!times || limits.max_connections == 0 || limits.max_waiting == 0 ||
        options.first_update_bytes < 2048 || limits.max_in_flight == 0 ||
        limits.max_in_flight_bytes == 0 || options.access.token.size() > kMaxToken) {
      return Status::invalid_argument;
    }
    // What is on its way can be taken back.
    auto distributor =
        Distributor::create({.backend = options.backend,
                             .settings = options.settings,
                             .backends = options.backends,
                             .threads = options.threads,
                             .region = options.region,
                             .max_clients = limits.max_clients,
                             .all_visible = true,
                             .max_unacknowledged = max_unacknowledged(limits.max_in_flight)});
    if (!distributor) return distributor.status();
    Ticket ticket{};
    if (const Status status = draw(options, ticket); status != Status::ok) return status;
    std::uint64_t epoch = options.epoch;
    if (epoch == 0) {
      const Status status = draw(options, std::as_writable_bytes(std::span(&epoch, 1)));
      if (status != Status::ok) return status;
      if (epoch == 0) return Status::backend_failed;  // No source of randomness.
    }
    auto state = std::make_unique<State>(*std::move(distributor), options);
    state->options.epoch = epoch;
    return Server(std::move(state));
  });
}

Result<ConnectionId> Server::connect(double now, std::string_view origin) {
  return guarded([&]() -> Result<ConnectionId> {
    const ServerOptions& options = state_->options;
    if (!std::isfinite(now)) return Status::invalid_time;
    if (state_->connections.size() >= options.limits.max_connections) return Status::limit_exceeded;
    auto connection = std::make_unique<Connection>(state_->options.first_update_bytes);
    connection->id = state_->next_connection++;
    if (!origin.empty()) connection->origin = std::hash<std::string_view>()(origin) | 1;
    connection->connected = connection->progress = now;
    connection->messages_left = {state_->message_burst, now};
    connection->resyncs_left = {kResyncBurst * options.limits.resyncs_per_second, now};
    const ConnectionId id = connection->id;
    state_->connections.emplace(id, std::move(connection));
    state_->make_room_to_wait();
    return id;
  });
}

/// Drops the oldest connection without a Hello if there are too many of them.
void Server::State::make_room_to_wait() noexcept {
  Connection* oldest = nullptr;
  std::uint32_t waiting = 0;
  for (const auto& [id, connection] : connections) {
    if (connection->dropped || connection->session != nullptr) continue;
    ++waiting;
    if (oldest == nullptr) oldest = connection.get();
  }
  if (waiting > options.limits.max_waiting) drop(*oldest, Reason::silent);
}

void Server::disconnect(ConnectionId connection, double now) {
  Connection* const found = state_->find(connection);
  if (found == nullptr) return;
  if (Session* session = found->session; session != nullptr) {
    session->connection = 0;
    session->lost = now;
    static_cast<void>(state_->distributor.suspend(session->client, true));
  }
  if (found->farewell) {
    static_cast<void>(guarded([&]() -> Status {
      state_->tell(*found->farewell);
      return Status::ok;
    }));
  }
  state_->connections.erase(connection);
}

void Server::drop(ConnectionId connection, Reason reason) {
  if (Connection* const found = state_->find(connection); found != nullptr)
    state_->drop(*found, reason);
}

void Server::tick(double now) {
  static_cast<void>(guarded([&]() -> Status {
    const ServerOptions& options = state_->options;
    for (const auto& [id, connection] : state_->connections) {
      if (connection->session == nullptr) {
        if (now - connection->connected > options.timeouts.hello)
          state_->drop(*connection, Reason::silent);
      } else if (!connection->in_flight.empty() &&
                 now - connection->progress > options.timeouts.stall) {
        state_->drop(*connection, Reason::stalled);
      }
    }
    for (auto it = state_->sessions.begin(); it != state_->sessions.end();) {
      Session& session = *(it++)->second;
      if (session.connection != 0 || now - session.lost <= options.timeouts.linger) continue;
      state_->tell({ServerEvent::Type::expired, 0, session.client, Reason::left});
      state_->end(session);
    }
    return Status::ok;
  }));
}

std::vector<OutgoingMessage> Server::take_messages(ConnectionId connection) {
  Connection* const found = state_->find(connection);
  if (found == nullptr) return {};
  found->volumes_sent = 0;
  return std::exchange(found->messages, {});
}

std::vector<ServerEvent> Server::take_events() {
  // What there is no memory for is said the next time.
  static_cast<void>(guarded([&]() -> Status {
    for (const auto& [id, connection] : state_->connections) {
      if (!connection->farewell) continue;
      state_->tell(*connection->farewell);
      connection->farewell.reset();
    }
    return Status::ok;
  }));
  return std::exchange(state_->events, {});
}

Result<std::vector<ConnectionId>> Server::connections() const {
  return guarded([&]() -> Result<std::vector<ConnectionId>> {
    std::vector<ConnectionId> ids;
    for (const auto& [id, connection] : state_->connections) {
      if (connection->session != nullptr) ids.push_back(id);
    }
    return ids;
  });
}

std::optional<ClientId> Server::client(ConnectionId connection) const {
  const Connection* const found = state_->find_session(connection);
  if (found == nullptr) return std::nullopt;
  return found->session->client;
}

std::optional<Viewpoint> Server::viewpoint(ConnectionId connection) const {
  const Connection* const found = state_->find_session(connection);
  return found == nullptr ? std::nullopt : found->session->viewpoint;
}

std::optional<ConnectionStatistics> Server::statistics(ConnectionId connection) const {
  const Connection* const found = state_->find(connection);
  if (found == nullptr || found->statistics.client == 0) return std::nullopt;
  ConnectionStatistics statistics = found->statistics;
  statistics.in_flight = static_cast<std::uint32_t>(found->in_flight.size());
  statistics.update_bytes = static_cast<std::uint64_t>(found->congestion.bytes());
  if (const auto state = state_->distributor.state(statistics.client); state) {
    statistics.pending = state->pending + state_->distributor.pending_shared(statistics.client);
    statistics.oldest_pending = state->oldest_pending;
    statistics.preset = state->preset;
    statistics.memory = state_->distributor.memory_of(statistics.client);
  }
  return statistics;
}

std::vector<float> Server::take_latencies(ConnectionId connection) {
  Connection* const found = state_->find(connection);
  return found == nullptr ? std::vector<float>() : std::exchange(found->latencies, {});
}

std::size_t Server::memory() const noexcept {
  std::size_t bytes = state_->distributor.memory();
  for (const auto& [client, session] : state_->sessions) {
    bytes += state_->distributor.memory_of(session->client);
  }
  for (const auto& [id, connection] : state_->connections) {
    bytes += sizeof(Connection);
    for (const OutgoingMessage& message : connection->messages) {
      bytes += message.head.capacity();
      if (message.rest == nullptr) continue;
      const auto holders = static_cast<std::size_t>(std::max(1L, message.rest.use_count()));
      bytes += message.rest->capacity() / holders;
    }
  }
  return bytes;
}

}  // namespace gicodec
