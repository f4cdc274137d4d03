// Answers to the messages of clients. Every message is hostile until it is checked.
#include "base/guard.h"
#include "base/secret.h"
#include "session/server/server_state.h"

#include <algorithm>

namespace gicodec {
namespace {

/// Latencies kept for take_latencies().
constexpr std::size_t kMaxLatencies = 4096;

bool same_text(const std::string& a, const std::string& b) noexcept {
  return same_secret(std::as_bytes(std::span(a)), std::as_bytes(std::span(b)));
}

}  // namespace

void Server::receive(ConnectionId connection, std::span<const std::byte> message, double now) {
  Connection* const found = state_->find(connection);
  if (found == nullptr || found->dropped) return;
  const Status status = guarded([&]() -> Status {
    state_->take(*found, message, now);
    return Status::ok;
  });
  if (status != Status::ok) state_->drop(*found, Reason::exhausted);
}

void Server::State::take(Connection& connection, std::span<const std::byte> bytes, double now) {
  if (!connection.messages_left.take(now, options.limits.messages_per_second, message_burst)) {
    return drop(connection, Reason::flood);
  }

  const MessageLimits limits{options.limits.max_message_bytes, largest_group};
  const auto message = read_message(bytes, limits);
  switch (message.status()) {
    case Status::ok:
      // A Hello comes first, and once; a Goodbye may come before it.
      if (!std::holds_alternative<Goodbye>(*message) &&
          std::holds_alternative<Hello>(*message) != (connection.session == nullptr)) {
        return drop(connection, Reason::out_of_order);
      }
      return std::visit([&](const auto& one) { answer(connection, one, now); }, *message);
    case Status::unsupported_version:
      return drop(connection, Reason::version);
    case Status::limit_exceeded:
      return drop(connection,
                  bytes.size() > limits.max_bytes ? Reason::too_large : Reason::malformed);
    case Status::out_of_memory:
      return drop(connection, Reason::exhausted);
    default:
      return drop(connection, Reason::malformed);
  }
}

void Server::State::answer(Connection& connection, const Hello& hello, double now) {
  if (options.access.authorise) {
    if (const auto refused = options.access.authorise(connection.id, hello.token))
      return drop(connection, *refused);
  } else if (!options.access.token.empty() && !same_text(hello.token, options.access.token)) {
    return drop(connection, Reason::token);
  }
  const auto ticket = draw_ticket();
  if (!ticket) return drop(connection, Reason::full);
  Session* const known = session_of(hello.ticket);
  const bool resumed = known != nullptr && known->delivery == hello.delivery;
  Session* const session = resumed ? known : session_for(connection, hello, now);
  if (session == nullptr) return;
  session->ticket = *ticket;
  session->budget = hello.budget;
  if (Connection* const before = find(session->connection); before != nullptr) {
    before->session = nullptr;  // Dropping it must not end the session.
    drop(*before, Reason::replaced);
  }
  session->connection = connection.id;
  connection.session = session;
  connection.progress = now;
  connection.statistics.client = session->client;
  connection.statistics.delivery = session->delivery;
  static_cast<void>(distributor.suspend(session->client, false));
  static_cast<void>(distributor.set_budget(session->client, hello.budget));
  const auto held = resumed ? std::span(hello.held) : std::span<const HeldState>();
  if (!take_held(connection, hello.sync, hello.generation, held)) return;
  event(resumed ? ServerEvent::Type::resumed : ServerEvent::Type::joined, connection);
  const Welcome welcome{hello.sync,    session->ticket, resumed,    session->delivery,
                        options.epoch, options.scene,   generation, described_now()};
  const Status sent = send(connection, welcome);
  if (sent != Status::ok) drop(connection, Reason::exhausted);
  connection.welcomed = now;
}

Status draw(const ServerOptions& options, std::span<std::byte> bytes) {
  return options.access.random ? options.access.random(bytes) : system_random(bytes);
}

/// backend_failed if the ticket is in use or zero: the source of randomness is broken.
Result<Ticket> Server::State::draw_ticket() const {
  Ticket ticket{};
  const Status status = draw(options, ticket);
  if (status != Status::ok) return status;
  const auto same = [&](const auto& entry) { return entry.second->ticket == ticket; };
  if (ticket == Ticket{} || std::any_of(sessions.begin(), sessions.end(), same))
    return Status::backend_failed;
  return ticket;
}

/// Compares all sessions, so that the time it takes does not depend on the tickets.
Session* Server::State::session_of(const Ticket& ticket) {
  Session* found = nullptr;
  for (const auto& [client, session] : sessions) {
    if (same_secret(session->ticket, ticket)) found = session.get();
  }
  return found;
}

/// A new session. Null if there is none: the connection is then dropped.
Session* Server::State::session_for(Connection& connection, const Hello& hello, double now) {
  // Allocates the entry first, which may fail.
  std::map<ClientId, std::unique_ptr<Session>> place;
  place.emplace(0, std::make_unique<Session>());
  const bool unicast = hello.delivery == Delivery::unicast;
  if (unicast && too_many_unicast(connection.origin))
    make_room(Delivery::unicast, connection.origin);
  if (unicast && too_many_unicast(connection.origin)) {
    drop(connection, Reason::unicast_full);
    return nullptr;
  }
  auto client = distributor.connect(hello.delivery, hello.budget);
  if (client.status() == Status::limit_exceeded) {
    make_room(Delivery::shared, 0);
    client = distributor.connect(hello.delivery, hello.budget);
  }
  if (!client) {
    drop(connection, client.status() == Status::out_of_memory         ? Reason::exhausted
                     : client.status() == Status::unsupported_backend ? Reason::unicast_full
                                                                      : Reason::full);
    return nullptr;
  }
  auto node = place.extract(place.begin());
  node.key() = *client;
  Session& session = *node.mapped();
  session.client = *client;
  session.delivery = hello.delivery;
  session.origin = connection.origin;
  session.lost = session.credit_at = now;
  session.credit = static_cast<double>(options.limits.max_bytes_per_second);
  sessions.insert(std::move(node));
  return &session;
}

bool Server::State::too_many_unicast(std::size_t origin) const noexcept {
  const auto all = std::count_if(sessions.begin(), sessions.end(), [](const auto& entry) {
    return entry.second->delivery == Delivery::unicast;
  });
  return static_cast<std::size_t>(all) >= options.limits.max_unicast || too_many_of(origin);
}

bool Server::State::too_many_of(std::size_t origin) const noexcept {
  const auto same = std::count_if(sessions.begin(), sessions.end(), [&](const auto& entry) {
    return entry.second->delivery == Delivery::unicast && entry.second->origin == origin;
  });
  return origin != 0 && options.limits.max_unicast_per_origin != 0 &&
         static_cast<std::size_t>(same) >= options.limits.max_unicast_per_origin;
}

/// Ends a session without a connection: of the origin that has most of these, the oldest. If
/// `delivery` is unicast, only a unicast session, and one of `origin` if that has too many.
void Server::State::make_room(Delivery delivery, std::size_t origin) {
  const bool of_origin = delivery == Delivery::unicast && too_many_of(origin);
  const auto fits = [&](const Session& session) {
    return session.connection == 0 &&
           (delivery == Delivery::shared || session.delivery == delivery) &&
           (!of_origin || session.origin == origin);
  };
  std::map<std::size_t, std::uint32_t> waiting;
  for (const auto& [client, session] : sessions) {
    if (fits(*session)) ++waiting[session->origin];
  }
  Session* chosen = nullptr;
  const auto before = [&](const Session& a, const Session& b) {
    const std::uint32_t of_a = waiting[a.origin], of_b = waiting[b.origin];
    return of_a != of_b ? of_a > of_b : a.lost < b.lost;
  };
  for (const auto& [client, session] : sessions) {
    if (!fits(*session)) continue;
    if (chosen == nullptr || before(*session, *chosen)) chosen = session.get();
  }
  if (chosen == nullptr) return;
  tell({ServerEvent::Type::expired, 0, chosen->client, Reason::full});
  end(*chosen);
}

/// Opens a sync point: the client holds the listed states and nothing else. False if the connection
/// was dropped.
bool Server::State::take_held(Connection& connection, std::uint32_t sync,
                              std::uint32_t of_generation, std::span<const HeldState> held) {
  Session& session = *connection.session;
  connection.sync = sync;
  connection.number = 0;
  std::set<StreamId> listed;
  const auto volumes = distributor.table();
  for (const HeldState& state : held) {
    // Skips a volume that has gone since.
    const std::uint16_t volume = state.stream.volume;
    if (volume < volumes.size() && volumes[volume]->changed_in > of_generation) continue;
    const bool twice = !listed.insert(state.stream).second;
    const Status status =
        distributor.resume(session.client, state.stream, state.sequence, state.checksum);
    if (twice || status != Status::ok) {
      drop(connection, twice ? Reason::malformed : Reason::unknown_volume);
      return false;
    }
  }
  for (const StreamId stream : session.streams) {
    if (listed.contains(stream)) continue;
    static_cast<void>(distributor.resume(session.client, stream, 0, 0));
  }
  return true;
}

void Server::State::answer(Connection& connection, const Resync& resync, double now) {
  if (resync.sync <= connection.sync) return;  // Answered already.
  const double rate = options.limits.resyncs_per_second;
  if (!connection.resyncs_left.take(now, rate, kResyncBurst * rate))
    return drop(connection, Reason::flood);
  ++connection.statistics.resyncs;
  if (!take_held(connection, resync.sync, resync.generation, resync.held)) return;
  if (resync.generation < generation) send_volumes(connection);
}

void Server::State::answer(Connection& connection, const Acknowledge& acknowledge, double now) {
  if (acknowledge.sync > connection.sync) return drop(connection, Reason::out_of_order);
  if (acknowledge.sync < connection.sync) return;
  if (acknowledge.number > connection.number) return drop(connection, Reason::malformed);
  if (connection.welcomed)
    connection.congestion.answered(now - *std::exchange(connection.welcomed, {}), now);
  // Messages arrive in order: an acknowledged update means that those of earlier sync points have
  // arrived too. Until then they count as in flight.
  const auto arrived = [&](const InFlight& update) {
    return update.sync < acknowledge.sync || update.number <= acknowledge.number;
  };
  while (!connection.in_flight.empty() && arrived(connection.in_flight.front())) {
    const InFlight& done = connection.in_flight.front();
    const bool agreed = done.sync == connection.sync;
    if (connection.session->delivery == Delivery::unicast && agreed) {
      for (const auto& [stream, sequence] : done.packets) {
        static_cast<void>(distributor.acknowledge(connection.session->client, stream, sequence));
      }
    }
    if (connection.latencies.size() < kMaxLatencies) {
      connection.latencies.push_back(static_cast<float>(now - done.made));
    }
    connection.statistics.in_flight_bytes -= done.sent.bytes;
    // Updates of an earlier sync point say nothing about the path.
    if (agreed) connection.congestion.acknowledged(done.sent, now, interval, mean_bytes);
    connection.progress = now;
    connection.in_flight.pop_front();
  }
}

void Server::State::answer(Connection& connection, const Viewpoint& viewpoint, double) {
  connection.session->viewpoint = viewpoint;
  event(ServerEvent::Type::viewpoint, connection);
}

void Server::State::answer(Connection& connection, const Subscribe& subscribe, double now) {
  const auto volumes = distributor.table();
  if (subscribe.volume >= volumes.size()) return drop(connection, Reason::unknown_volume);
  // Ignores a volume that has gone since.
  const ServedVolume& volume = *volumes[subscribe.volume];
  if (volume.changed_in > subscribe.generation) return;
  if (!connection.messages_left.take(now, options.limits.messages_per_second, message_burst,
                                     subscribe_cost(volume))) {
    return drop(connection, Reason::flood);
  }
  const Status status = distributor.set_visible(connection.session->client, subscribe.volume,
                                                subscribe.blocks, subscribe.group);
  if (status == Status::out_of_memory) return drop(connection, Reason::exhausted);
  if (status == Status::mask_mismatch) return drop(connection, Reason::malformed);
  if (status != Status::ok) return drop(connection, Reason::unknown_volume);
  event(ServerEvent::Type::subscribed, connection);
}

void Server::State::answer(Connection& connection, const Goodbye&, double) {
  drop(connection, Reason::left);
}

}  // namespace gicodec
