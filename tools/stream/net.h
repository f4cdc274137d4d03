// The network of the programs: links over ENet, WebSockets and NATS, and their events.
#pragma once

#include "enet.h"
#include "nats_receiver.h"
#include "transport.h"
#include "web.h"

#include <memory>
#include <optional>
#include <vector>

namespace gicodec::streaming {

inline constexpr double kGoodbye = 0.7;  ///< seconds for the last messages to arrive

/// One thread; throws tools::Error of Exit::io.
class Net {
 public:
  /// Listens at these addresses, of which at least one must be given.
  Net(const std::optional<Address>& enet, const std::optional<WebListen>& web,
      const NetOptions& options);
  /// Only connects, to servers of this kind.
  Net(Via via, const NetOptions& options);

  /// Begins to connect; `opened` or `closed` follows.
  [[nodiscard]] Link connect(const Address& address);
  /// Sends and receives for at most so long; false if nothing happened.
  [[nodiscard]] bool next(NetEvent& event, unsigned milliseconds);
  /// False if the link is not open any more.
  bool send(Link link, const OutgoingMessage& message);
  /// Puts what is queued on the wire without waiting for next().
  void flush();
  /// Confirms packets that have arrived, so that a busy program does not time out; next() returns
  /// them later.
  void attend();
  /// Closes the link once all messages have arrived; `closed` follows.
  void close(Link link);
  /// Closes at once, without an event.
  void abandon(Link link);

  /// The port of ENet, then that of WebSockets.
  [[nodiscard]] std::vector<std::uint16_t> ports() const;
  [[nodiscard]] static std::string host_of(Link link);     ///< origin, see Server::connect()
  [[nodiscard]] static std::string address_of(Link link);  ///< "127.0.0.1:51022"
  [[nodiscard]] static unsigned round_trip_ms(Link link);

  /// Sets the caller's number of the link; 0 at first.
  static void set_tag(Link link, std::uintptr_t tag);
  [[nodiscard]] static std::uintptr_t tag(Link link);

  /// Connections to the port of WebSockets that were closed unheard since the last call.
  [[nodiscard]] TurnedAway turned_away();
  /// Sets the metrics that the port of WebSockets shows.
  void show(std::string metrics);
  /// Reads the certificate again, for new connections. Throws tools::Error.
  void reload();

 private:
  [[nodiscard]] bool next_of_any(NetEvent& event);
  [[nodiscard]] bool next_of_nats(NetEvent& event, unsigned milliseconds);

  std::unique_ptr<Enet> enet_;
  std::unique_ptr<Web> web_;
  std::vector<std::unique_ptr<NatsReceiver>> nats_;
  NetOptions options_;
  WebListen listen_;
  bool web_first_ = false;
};

}  // namespace gicodec::streaming
