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
  if (status != Status::ok) state_->drop(*found, Reason::exhausted);
}

void Host::State::take(Peer& peer, std::span<const std::byte> bytes, double now) {
  if (!peer.messages_left.take(now, options.messages_per_second, message_burst)) {
    return drop(peer, Reason::flood);
  }

  const MessageLimits limits{options.max_message_bytes, largest_set};
  const auto message = read_message(bytes, limits);
  switch (message.status()) {
    case Status::ok:
      // A Hello comes first, and once; a Goodbye may come before it.
      if (!std::holds_alternative<Goodbye>(*message) &&
          std::holds_alternative<Hello>(*message) != (peer.session == nullptr)) {
        return drop(peer, Reason::out_of_order);
      }
      return std::visit([&](const auto& one) { answer(peer, one, now); }, *message);
    case Status::unsupported_version:
      return drop(peer, Reason::version);
    case Status::limit_exceeded:
      return drop(peer, bytes.size() > limits.max_bytes ? Reason::too_large : Reason::malformed);
    case Status::out_of_memory:
      return drop(peer, Reason::exhausted);
    default:
      return drop(peer, Reason::malformed);
  }
}

void Host::State::answer(Peer& peer, const Hello& hello, double now) {
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
  const auto held = resumed ? std::span(hello.held) : std::span<const HeldState>();
  if (!take_held(peer, hello.epoch, hello.edition, held)) return;
  event(resumed ? HostEvent::Kind::resumed : HostEvent::Kind::joined, peer);
  const Welcome welcome{hello.epoch,   session->ticket, resumed, session->delivery,
                        options.epoch, options.scene,   edition, described_now()};
  const Status sent = send(peer, welcome);
  if (sent != Status::ok) drop(peer, Reason::exhausted);
  peer.welcomed = now;
}

Status draw(const HostOptions& options, std::span<std::byte> bytes) {
  return options.random ? options.random(bytes) : system_random(bytes);
}

/// Never one that somebody holds: a source that repeats itself is broken.
Result<Ticket> Host::State::draw_ticket() const {
  Ticket ticket{};
  const Status status = draw(options, ticket);
  if (status != Status::ok) return status;
  const auto same = [&](const auto& entry) { return entry.second->ticket == ticket; };
  if (ticket == Ticket{} || std::any_of(sessions.begin(), sessions.end(), same))
    return Status::backend_failed;
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
  // Its place in the table first, which is what may fail.
  std::map<ClientId, std::unique_ptr<Session>> place;
  place.emplace(0, std::make_unique<Session>());
  const bool own = hello.delivery == Delivery::own;
  if (own && too_many_own(peer.origin)) make_room(Delivery::own, peer.origin);
  if (own && too_many_own(peer.origin)) {
    drop(peer, Reason::own_full);
    return nullptr;
  }
  auto client = server.connect(hello.delivery, hello.budget);
  if (client.status() == Status::limit_exceeded) {
    make_room(Delivery::shared, 0);
    client = server.connect(hello.delivery, hello.budget);
  }
  if (!client) {
    drop(peer, client.status() == Status::out_of_memory ? Reason::exhausted : Reason::full);
    return nullptr;
  }
  auto node = place.extract(place.begin());
  node.key() = *client;
  if (const Status shown = show_everything(*client); shown != Status::ok) {
    static_cast<void>(server.disconnect(*client));
    drop(peer, Reason::exhausted);
    return nullptr;
  }
  Session& session = *node.mapped();
  session.client = *client;
  session.delivery = hello.delivery;
  session.origin = peer.origin;
  session.lost = session.credit_at = now;
  session.credit = static_cast<double>(options.max_bytes_per_second);
  sessions.insert(std::move(node));
  return &session;
}

bool Host::State::too_many_own(std::size_t origin) const noexcept {
  const auto all = std::count_if(sessions.begin(), sessions.end(), [](const auto& entry) {
    return entry.second->delivery == Delivery::own;
  });
  return static_cast<std::size_t>(all) >= options.max_own || too_many_of(origin);
}

bool Host::State::too_many_of(std::size_t origin) const noexcept {
  const auto same = std::count_if(sessions.begin(), sessions.end(), [&](const auto& entry) {
    return entry.second->delivery == Delivery::own && entry.second->origin == origin;
  });
  return origin != 0 && options.max_own_per_origin != 0 &&
         static_cast<std::size_t>(same) >= options.max_own_per_origin;
}

/// Forgets a session that waits for its client to come back: of the origin that has most of them,
/// the one that has waited longest. For a place among own packets, one that has such a place, and
/// of this origin if it has too many.
void Host::State::make_room(Delivery delivery, std::size_t origin) {
  const bool of_origin = delivery == Delivery::own && too_many_of(origin);
  const auto fits = [&](const Session& session) {
    return session.peer == 0 && (delivery == Delivery::shared || session.delivery == delivery) &&
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
  events.push_back({HostEvent::Kind::expired, 0, chosen->client, Reason::full});
  end(*chosen);
}

/// Opens an epoch: what the client holds is what it says, and nothing else. False if it was
/// dropped.
bool Host::State::take_held(Peer& peer, std::uint32_t epoch, std::uint32_t of_edition,
                            std::span<const HeldState> held) {
  Session& session = *peer.session;
  peer.epoch = epoch;
  peer.number = 0;
  std::set<StreamId> listed;
  for (const HeldState& state : held) {
    // Of a volume that has gone since nothing is held.
    const std::uint16_t volume = state.stream.volume;
    if (volume < volumes.size() && volumes[volume].since > of_edition) continue;
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
  if (resync.epoch <= peer.epoch) return;  // Answered already.
  const double rate = options.resyncs_per_second;
  if (!peer.resyncs_left.take(now, rate, kResyncBurst * rate)) return drop(peer, Reason::flood);
  ++peer.statistics.resyncs;
  if (!take_held(peer, resync.epoch, resync.edition, resync.held)) return;
  if (resync.edition < edition) send_volumes(peer);
}

void Host::State::answer(Peer& peer, const Acknowledge& acknowledge, double now) {
  if (acknowledge.epoch > peer.epoch) return drop(peer, Reason::out_of_order);
  if (acknowledge.epoch < peer.epoch) return;
  if (acknowledge.number > peer.number) return drop(peer, Reason::malformed);
  if (peer.welcomed) peer.pace.answered(now - *std::exchange(peer.welcomed, {}), now);
  // Messages come in order: with an update, all of earlier epochs have arrived. Until then they are
  // on their way, whatever the peer has asked for meanwhile.
  const auto arrived = [&](const InFlight& update) {
    return update.epoch < acknowledge.epoch || update.number <= acknowledge.number;
  };
  while (!peer.in_flight.empty() && arrived(peer.in_flight.front())) {
    const InFlight& done = peer.in_flight.front();
    const bool agreed = done.epoch == peer.epoch;
    if (peer.session->delivery == Delivery::own && agreed) {
      for (const auto& [stream, sequence] : done.packets) {
        static_cast<void>(server.acknowledge(peer.session->client, stream, sequence));
      }
    }
    if (peer.latencies.size() < kMaxLatencies) {
      peer.latencies.push_back(static_cast<float>(now - done.made));
    }
    peer.statistics.in_flight_bytes -= done.sent.bytes;
    // What was lost tells nothing of the way.
    if (agreed) peer.pace.acknowledged(done.sent, now, interval, mean_bytes);
    peer.progress = now;
    peer.in_flight.pop_front();
  }
}

void Host::State::answer(Peer& peer, const Viewpoint& viewpoint, double) {
  peer.session->viewpoint = viewpoint;
  event(HostEvent::Kind::viewpoint, peer);
}

void Host::State::answer(Peer& peer, const Subscribe& subscribe, double now) {
  if (subscribe.volume >= volumes.size()) return drop(peer, Reason::unknown_volume);
  // One that has gone since.
  if (volumes[subscribe.volume].since > subscribe.edition) return;
  if (!peer.messages_left.take(now, options.messages_per_second, message_burst,
                               volumes[subscribe.volume].subscribe_cost)) {
    return drop(peer, Reason::flood);
  }
  const Status status =
      server.set_visible(peer.session->client, subscribe.volume, subscribe.blocks, subscribe.set);
  if (status == Status::out_of_memory) return drop(peer, Reason::exhausted);
  if (status == Status::mask_mismatch) return drop(peer, Reason::malformed);
  if (status != Status::ok) return drop(peer, Reason::unknown_volume);
  event(HostEvent::Kind::subscribed, peer);
}

void Host::State::answer(Peer& peer, const Goodbye&, double) { drop(peer, Reason::left); }

}  // namespace gicodec
