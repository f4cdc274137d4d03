// The state of a Server. server.cpp has the connections, server_volumes.cpp the volumes,
// server_updates.cpp the updates, server_messages.cpp the answers to clients, server_congestion.cpp
// what each client gets in an update.
#pragma once

#include <gicodec/server.h>

#include "session/server/congestion_control.h"
#include "session/server/distributor.h"
#include "session/server/served_volume.h"

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace gicodec {

/// A client of the server. Outlives its connection by ServerTimeouts::linger.
struct Session {
  Ticket ticket = {};
  ClientId client = 0;
  Delivery delivery = Delivery::unicast;
  Budget budget;                     ///< that the client asked for
  std::size_t origin = 0;            ///< hash; 0: not known
  ConnectionId connection = 0;       ///< 0 while there is no connection
  double lost = 0;                   ///< when the connection was lost
  double credit = 0, credit_at = 0;  ///< bytes of updates that its rate leaves it, and when
  bool unicast_limited = false;      ///< unicast_blocks limits the next update
  std::uint32_t unicast_blocks = 0;
  std::optional<Viewpoint> viewpoint;
  std::set<StreamId> streams;  ///< all streams that it was ever sent
};

/// An update that a client has not acknowledged.
struct InFlight {
  std::uint32_t sync = 0, number = 0;
  double made = 0;
  CongestionControl::Sent sent;
  std::vector<std::pair<StreamId, std::uint32_t>> packets;  ///< and their sequences
};

/// Limits a rate on average, and its bursts.
struct Allowance {
  double left = 0, at = 0;

  [[nodiscard]] bool take(double now, double per_second, double burst, double many = 1) noexcept {
    left = std::min(burst, left + std::max(now - at, 0.0) * per_second);
    at = now;
    if (left < many) return false;
    left -= many;
    return true;
  }
};

/// A connection.
struct Connection {
  explicit Connection(std::uint64_t first_update_bytes) : congestion(first_update_bytes) {}
  ConnectionId id = 0;
  std::size_t origin = 0;      ///< hash; 0: not known
  Session* session = nullptr;  ///< from its Hello on
  bool dropped = false;
  /// What it gets in this update; a reminder is empty and does not count as in flight.
  enum class Turn : std::uint8_t { none, reminder, empty, full } turn = Turn::full;
  double reminded = 0;                    ///< when the last reminder was made
  std::optional<ServerEvent> farewell;    ///< event of a dropped client, until take_events()
  double connected = 0, progress = 0;     ///< progress: last acknowledgement, or nothing in flight
  Allowance messages_left, resyncs_left;  ///< that it may send
  std::uint32_t sync = 0, number = 0;     ///< of the last update made for it
  std::deque<InFlight> in_flight;
  std::optional<double> welcomed;  ///< when its Welcome was made, until that is acknowledged
  CongestionControl congestion;
  bool congestion_limited = false;  ///< congestion control is what limits its bytes
  bool ready = true;  ///< in the last update it could have had blocks, but for its turn
  std::vector<OutgoingMessage> messages;
  std::size_t volumes_sent = 0;  ///< number of messages when the last list of volumes was added
  std::vector<float> latencies;
  ConnectionStatistics statistics;
};

inline constexpr double kResyncBurst = 10;  ///< seconds' worth
/// Blocks of a volume that make a Subscribe count for one message more.
inline constexpr double kBlocksOfAMessage = 16384;

/// Messages that a Subscribe to a volume counts as, beyond the first.
[[nodiscard]] double subscribe_cost(const ServedVolume& volume) noexcept;

/// Unpredictable bytes.
Status draw(const ServerOptions& options, std::span<std::byte> bytes);

class SharedUpdates;

struct Server::State {
  State(Distributor&& distributor_in, const ServerOptions& options_in)
      : options(options_in),
        distributor(std::move(distributor_in)),
        message_burst(options_in.limits.messages_per_second) {}

  [[nodiscard]] Connection* find(ConnectionId connection);
  /// Null if it does not exist, was dropped, or has no session.
  [[nodiscard]] const Connection* find_session(ConnectionId connection) const noexcept;
  void tell(const ServerEvent& event);
  void event(ServerEvent::Type kind, const Connection& connection);
  Status send(Connection& connection, const AnyMessage& message);
  void drop(Connection& connection, Reason reason) noexcept;
  void end(Session& session) noexcept;
  Status send_update(Connection& connection, SharedUpdates& shared, double now, double time);
  [[nodiscard]] Result<DescribedVolume> describe(std::string name, const VolumeDesc& volume,
                                                 std::span<const StreamedTexture> textures) const;
  void send_volumes_to_all() noexcept;
  void send_volumes(Connection& connection) noexcept;
  [[nodiscard]] std::vector<DescribedVolume> described_now() const;
  void choose_turn(Connection& connection, double now) noexcept;
  [[nodiscard]] static std::optional<double> oldest_filled(const Connection& connection) noexcept;
  void set_limit_for_few(double blocks) noexcept;
  [[nodiscard]] bool fits_rate(Connection& connection, std::uint64_t bytes, double now) noexcept;
  void measure_interval(double now) noexcept;
  void make_room_to_wait() noexcept;
  void share_unicast_blocks() noexcept;

  void take(Connection& connection, std::span<const std::byte> bytes, double now);
  void answer(Connection& connection, const Hello& hello, double now);
  void answer(Connection& connection, const Resync& resync, double now);
  void answer(Connection& connection, const Acknowledge& acknowledge, double now);
  void answer(Connection& connection, const Viewpoint& viewpoint, double now);
  void answer(Connection& connection, const Subscribe& subscribe, double now);
  void answer(Connection& connection, const Goodbye& goodbye, double now);
  template <typename FromServer>
  void answer(Connection& connection, const FromServer& /*unused*/, double /*unused*/) {
    drop(connection, Reason::out_of_order);
  }
  [[nodiscard]] Result<Ticket> draw_ticket() const;
  [[nodiscard]] Session* session_of(const Ticket& ticket);
  [[nodiscard]] Session* session_for(Connection& connection, const Hello& hello, double now);
  [[nodiscard]] bool too_many_unicast(std::size_t origin) const noexcept;
  [[nodiscard]] bool too_many_of(std::size_t origin) const noexcept;  ///< unicast sessions
  void make_room(Delivery delivery, std::size_t origin);
  [[nodiscard]] bool take_held(Connection& connection, std::uint32_t sync,
                               std::uint32_t of_generation, std::span<const HeldState> held);

  ServerOptions options;
  Distributor distributor;       ///< with the table of volumes
  std::uint32_t generation = 0;  ///< of the list of volumes: one more with each change
  /// Messages that a client may send at once: a second's worth, and a Subscribe to every group.
  double message_burst;
  std::uint32_t largest_group = 0;  ///< blocks; removed volumes count too
  std::map<ConnectionId, std::unique_ptr<Connection>> connections;
  std::map<ClientId, std::unique_ptr<Session>> sessions;
  std::vector<ServerEvent> events;
  ConnectionId next_connection = 1;
  double updated = -1;         ///< when the last update was made; negative: never
  double interval = 0;         ///< seconds between updates, recent mean
  double takers = 0;           ///< clients with sessions
  double total_credit = 0;     ///< bytes that all clients together may be sent
  double mean_bytes = 0;       ///< mean of CongestionControl::bytes()
  double limit_for_few = 0;    ///< 0: no limit
  double unicast_blocks = 0;   ///< left for unicast packets; below 0: overspent
  ConnectionId last_turn = 0;  ///< that had the last turn, see share_unicast_blocks()
};

}  // namespace gicodec
