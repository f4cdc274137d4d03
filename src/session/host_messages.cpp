// What peers say, and what comes of it. Every message is hostile until it was checked.
#include "base/guard.h"
#include "base/secret.h"
#include "session/host_state.h"

#include <algorithm>

namespace gicodec {
namespace {

/// Kept for take_latencies(); further ones are not.
constexpr std::size_t kMaxLatencies = 4096;

bool same_text(const std::string& a, const std::string& b) noexcept {
  return same_secret(std::as_bytes(std::span(a)), std::as_bytes(std::span(b)));
}

}  // namespace

void Host::receive(PeerId peer, std::span<const std::byte> message, double now) {
  Peer* const found = state_->find(peer);
  if (found == nullptr || found->dropped) return;
  const Status status = guarded([&]() -> Status {
    state_->take(*found, message, now);
    return Status::ok;
  });
  if (status != Status::ok) drop(peer, Reason::too_large);  // More than memory can hold.
}

void Host::State::take(Peer& peer, std::span<const std::byte> bytes, double now) {
  const double earned = (now - peer.allowance_at) * options.messages_per_second;
  peer.allowance = std::min(options.messages_per_second, peer.allowance + std::max(earned, 0.0));
  peer.allowance_at = now;
  if (peer.allowance < 1) return drop(peer, Reason::flood);
  peer.allowance -= 1;

  MessageLimits limits{options.max_message_bytes, 0};
  for (const DescribedVolume& volume : volumes) {
    const Grid grid = volume.geometry.grid;
    limits.max_probes = std::max(limits.max_probes, grid.x * grid.y * grid.z);
  }
  const auto message = read_message(bytes, limits);
  switch (message.status()) {
    case Status::ok:
      return std::visit([&](const auto& one) { answer(peer, one, now); }, *message);
    case Status::unsupported_version:
      return drop(peer, Reason::version);
    case Status::limit_exceeded:
    case Status::out_of_memory:
      return drop(peer, Reason::too_large);
    default:
      return drop(peer, Reason::malformed);
  }
}

void Host::State::answer(Peer& peer, const Hello& hello, double now) {
  if (peer.session != nullptr) return drop(peer, Reason::out_of_order);
  if (options.authorise) {
    if (const auto refused = options.authorise(peer.id, hello.token)) return drop(peer, *refused);
  } else if (!options.token.empty() && !same_text(hello.token, options.token)) {
    return drop(peer, Reason::token);
  }
  const auto ticket = draw_ticket();
  if (!ticket) return drop(peer, Reason::full);
  Session* const known = session_of(hello.ticket);
  const bool resumed = known != nullptr && known->delivery == hello.delivery;
  Session* const session = resumed ? known : session_for(peer, hello, now);
  if (session == nullptr) return;
  session->ticket = *ticket;
  session->budget = hello.budget;
  if (Peer* const before = find(session->peer); before != nullptr) {
    before->session = nullptr;  // The session is not to end with it.
    drop(*before, Reason::replaced);
  }
  session->peer = peer.id;
  peer.session = session;
  peer.progress = now;
  peer.statistics.client = session->client;
  peer.statistics.delivery = session->delivery;
  static_cast<void>(server.suspend(session->client, false));
  static_cast<void>(server.set_budget(session->client, hello.budget));
  if (!take_held(peer, hello.epoch, resumed ? hello.held : std::vector<HeldState>())) return;
  send(peer, Welcome{hello.epoch, session->ticket, resumed, session->delivery,
                     server.options().chunk, options.scene, volumes});
  event(resumed ? HostEvent::Kind::resumed : HostEvent::Kind::joined, peer);
}

/// Never one that somebody holds: a source that repeats itself is broken.
Result<Ticket> Host::State::draw_ticket() const {
  Ticket ticket{};
  const Status status = options.random ? options.random(ticket) : system_random(ticket);
  if (status != Status::ok) return status;
  const auto same = [&](const auto& entry) { return entry.second->ticket == ticket; };
  if (ticket == Ticket{} || std::ranges::any_of(sessions, same)) return Status::backend_failed;
  return ticket;
}

/// Looks at all of them, so that the time it takes tells nothing about tickets.
Session* Host::State::session_of(const Ticket& ticket) {
  Session* found = nullptr;
  for (const auto& [client, session] : sessions) {
    if (same_secret(session->ticket, ticket)) found = session.get();
  }
  return found;
}

/// A new session, or none: the peer is dropped then.
Session* Host::State::session_for(Peer& peer, const Hello& hello, double now) {
  auto client = server.connect(hello.delivery, hello.budget);
  if (client.status() == Status::limit_exceeded) {
    make_room();
    client = server.connect(hello.delivery, hello.budget);
  }
  if (!client) {
    drop(peer, Reason::full);
    return nullptr;
  }
  auto session = std::make_unique<Session>();
  session->client = *client;
  session->delivery = hello.delivery;
  session->lost = session->credit_at = now;
  session->credit = static_cast<double>(options.max_bytes_per_second);
  return sessions.emplace(*client, std::move(session)).first->second.get();
}

/// Forgets the session that has waited longest for its client to come back.
void Host::State::make_room() {
  Session* oldest = nullptr;
  for (const auto& [client, session] : sessions) {
    if (session->peer != 0) continue;
    if (oldest == nullptr || session->lost < oldest->lost) oldest = session.get();
  }
  if (oldest == nullptr) return;
  events.push_back({HostEvent::Kind::expired, 0, oldest->client, Reason::full});
  end(*oldest);
}

/// Opens an epoch: what the client holds is what it says, and nothing else. False if it was
/// dropped.
bool Host::State::take_held(Peer& peer, std::uint32_t epoch, std::span<const HeldState> held) {
  Session& session = *peer.session;
  peer.epoch = epoch;
  peer.number = 0;
  peer.in_flight.clear();
  peer.statistics.in_flight_bytes = 0;
  std::set<StreamId> listed;
  for (const HeldState& state : held) {
    const bool twice = !listed.insert(state.stream).second;
    const Status status =
        server.resume(session.client, state.stream, state.sequence, state.checksum);
    if (twice || status != Status::ok) {
      drop(peer, twice ? Reason::malformed : Reason::unknown_volume);
      return false;
    }
  }
  for (const StreamId stream : session.streams) {
    if (listed.contains(stream)) continue;
    static_cast<void>(server.resume(session.client, stream, 0, 0));
  }
  return true;
}

void Host::State::answer(Peer& peer, const Resync& resync, double now) {
  if (peer.session == nullptr) return drop(peer, Reason::out_of_order);
  if (resync.epoch <= peer.epoch) return;  // Answered already.
  ++peer.statistics.resyncs;
  peer.progress = now;
  static_cast<void>(take_held(peer, resync.epoch, resync.held));
}

void Host::State::answer(Peer& peer, const Acknowledge& acknowledge, double now) {
  if (peer.session == nullptr) return drop(peer, Reason::out_of_order);
  if (acknowledge.epoch > peer.epoch) return drop(peer, Reason::out_of_order);
  if (acknowledge.epoch < peer.epoch) return;
  if (acknowledge.number > peer.number) return drop(peer, Reason::malformed);
  while (!peer.in_flight.empty() && peer.in_flight.front().number <= acknowledge.number) {
    const InFlight& done = peer.in_flight.front();
    if (peer.session->delivery == Delivery::own) {
      for (const auto& [stream, sequence] : done.packets) {
        static_cast<void>(server.acknowledge(peer.session->client, stream, sequence));
      }
    }
    if (peer.latencies.size() < kMaxLatencies) {
      peer.latencies.push_back(static_cast<float>(now - done.made));
    }
    peer.statistics.in_flight_bytes -= done.bytes;
    peer.progress = now;
    peer.in_flight.pop_front();
  }
}

void Host::State::answer(Peer& peer, const Viewpoint& viewpoint, double) {
  if (peer.session == nullptr) return drop(peer, Reason::out_of_order);
  peer.session->viewpoint = viewpoint;
  event(HostEvent::Kind::viewpoint, peer);
}

void Host::State::answer(Peer& peer, const Subscribe& subscribe, double) {
  if (peer.session == nullptr) return drop(peer, Reason::out_of_order);
  const Status status =
      server.set_visible(peer.session->client, subscribe.volume, subscribe.probes);
  if (status != Status::ok) return drop(peer, Reason::unknown_volume);
  event(HostEvent::Kind::subscribed, peer);
}

void Host::State::answer(Peer& peer, const Goodbye&, double) { drop(peer, Reason::left); }

}  // namespace gicodec
