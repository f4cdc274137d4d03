// WebSockets: one binary message per message of the protocol, over TLS 1.3 or, on one machine, in
// clear.
#pragma once

#include "tls.h"
#include "transport.h"

#include <memory>
#include <string>

namespace gicodec::streaming {

/// Connections, served by a thread of their own. All calls come from one other thread, and throw
/// tools::Error of Exit::io.
class Web {
 public:
  /// Listens for connections. `certificate`: nullptr without encryption.
  Web(const WebListen& listen, TlsContext certificate, const NetOptions& options);
  /// Only connects.
  explicit Web(const NetOptions& options);
  ~Web();
  Web(const Web&) = delete;
  Web& operator=(const Web&) = delete;

  /// Begins to connect; `opened` or `closed` follows.
  [[nodiscard]] WebLink* connect(const Address& address);
  /// Takes the oldest event; false if there is none. Never waits.
  [[nodiscard]] bool next(NetEvent& event);
  /// Readable while there are events.
  [[nodiscard]] int descriptor() const;
  /// False if the link is not open any more. Breaks a link beyond NetOptions::max_unsent.
  bool send(WebLink* link, const OutgoingMessage& message);
  /// Closes the link once all messages have left, or after a while; `closed` follows.
  void close(WebLink* link);
  /// Closes at once, without an event.
  void abandon(WebLink* link);

  /// Connections that found no room since the last call.
  [[nodiscard]] TurnedAway turned_away();

  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] static const std::string& host_of(const WebLink* link);
  [[nodiscard]] static const std::string& address_of(const WebLink* link);
  [[nodiscard]] static unsigned round_trip_ms(const WebLink* link);
  static void set_tag(WebLink* link, std::uintptr_t tag);
  [[nodiscard]] static std::uintptr_t tag(const WebLink* link);

  /// Sets the answer to GET /metrics. A server that shows none for a while counts as unhealthy.
  void show(std::string metrics);
  /// Uses this certificate for new connections.
  void use(TlsContext certificate);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec::streaming
