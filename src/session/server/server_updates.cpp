// Updates: packets for all sessions, and the messages that carry them.
#include "base/guard.h"
#include "bitstream/update_message.h"
#include "session/server/server_state.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_map>

namespace gicodec {

/// The second piece of update messages, written once for all clients with the same packets.
class SharedUpdates {
 public:
  /// `message` has these packets.
  Status write_rest(const UpdateMessage& message, std::span<const OutgoingPacket> packets,
                    std::shared_ptr<const Message>& out);

 private:
  struct Shared {
    std::span<const OutgoingPacket> packets;
    std::shared_ptr<const Message> rest;
  };
  std::unordered_map<std::uint64_t, Shared> by_packets_;  ///< by a hash of them
};

Status SharedUpdates::write_rest(const UpdateMessage& message,
                                 std::span<const OutgoingPacket> packets,
                                 std::shared_ptr<const Message>& out) {
  constexpr std::uint64_t kPrime = 0x100000001B3;
  std::uint64_t hash = packets.size();
  for (const OutgoingPacket& packet : packets) {
    hash = (hash ^ std::hash<const Packet*>()(packet.packet.get()) ^ packet.tier) * kPrime;
  }
  const auto same = [](const OutgoingPacket& a, const OutgoingPacket& b) {
    return a.packet == b.packet && a.stream == b.stream && a.tier == b.tier;
  };
  // Messages with proofs are not shared: proofs depend on what the client holds.
  const auto found = by_packets_.find(hash);
  if (found != by_packets_.end() && message.proofs.empty() &&
      std::equal(packets.begin(), packets.end(), found->second.packets.begin(),
                 found->second.packets.end(), same)) {
    out = found->second.rest;
    return Status::ok;
  }
  auto rest = std::make_shared<Message>();
  const Status status = write_update_rest(message, *rest);
  if (status != Status::ok) return status;
  out = std::move(rest);
  if (message.proofs.empty()) by_packets_.try_emplace(hash, Shared{packets, out});
  return Status::ok;
}

Status Server::update(double now, double time) {
  if (!std::isfinite(now) || !std::isfinite(time)) return Status::invalid_time;
  tick(now);
  state_->measure_interval(now);
  state_->share_unicast_blocks();
  for (const auto& [id, connection] : state_->connections) {
    if (connection->session != nullptr) state_->choose_turn(*connection, now);
  }
  const std::uint64_t before = state_->distributor.updates();
  Status first = state_->distributor.update();
  if (state_->distributor.updates() == before) return first;
  SharedUpdates shared;
  for (const auto& [id, connection] : state_->connections) {
    if (connection->session == nullptr || connection->turn == Connection::Turn::none) continue;
    const Status status =
        guarded([&, to = connection.get()] { return state_->send_update(*to, shared, now, time); });
    if (status != Status::ok) {
      state_->drop(*connection, Reason::exhausted);  // It has missed packets of its streams.
      shared = {};                                   // May refer to its packets.
    }
    if (first == Status::ok) first = status;
  }
  return first;
}

Status Server::State::send_update(Connection& connection, SharedUpdates& shared, double now,
                                  double time) {
  Session& session = *connection.session;
  UpdateMessage message{
      connection.sync, connection.number + 1, generation, distributor.updates(), time, {}, {}, {}};
  InFlight sent{message.sync, message.number, now, {}, {}};
  std::uint64_t blocks = 0;
  const std::span<const OutgoingPacket> packets = distributor.packets(session.client);
  for (const OutgoingPacket& packet : packets) {
    message.parts.push_back({packet.stream, packet.tier, *packet.packet});
    sent.packets.emplace_back(packet.stream, packet.sequence);
    session.streams.insert(packet.stream);
    blocks += packet.blocks;
  }
  if (options.proofs) {
    for (const StreamId stream : session.streams) {
      const auto hash = distributor.state_hash(session.client, stream);
      if (hash) message.proofs.push_back({stream, *hash});
    }
  }
  for (const auto& volume : distributor.table()) {
    if (!volume->removed()) message.scrolls.push_back(volume->described.geometry.scroll);
  }
  sent.sent = {now,
               0,
               connection.congestion.delivered(),
               connection.congestion_limited && distributor.held_back(session.client),
               !oldest_filled(connection).has_value(),
               connection.turn == Connection::Turn::empty};
  const bool reminder = connection.turn == Connection::Turn::reminder;
  if (!reminder) connection.in_flight.push_back(std::move(sent));
  OutgoingMessage out;
  Status status = write_update_head(message, out.head);
  if (status == Status::ok) status = shared.write_rest(message, packets, out.rest);
  if (status != Status::ok) return status;
  const std::uint64_t bytes = out.size();
  connection.messages.push_back(std::move(out));
  ++connection.number;
  if (reminder) {
    connection.reminded = now;
  } else {
    connection.in_flight.back().sent.bytes = bytes;
    connection.statistics.in_flight_bytes += bytes;
  }
  session.credit -= static_cast<double>(bytes);
  if (session.unicast_limited) unicast_blocks -= static_cast<double>(blocks);
  total_credit -= static_cast<double>(bytes);
  connection.statistics.bytes += bytes;
  connection.statistics.blocks += blocks;
  ++connection.statistics.updates;
  return Status::ok;
}

}  // namespace gicodec
