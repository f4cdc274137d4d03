// WebSockets as the programs use them, one binary message for each of the protocol's, over TLS 1.3
// or, on one machine, in clear.
#pragma once

#include "tls.h"
#include "transport.h"

#include <memory>
#include <string>

namespace gicodec::streaming {

/// Connections, served by a thread of its own. Everything here on one other thread; throws
/// tools::Error of Exit::io.
class Web {
 public:
  /// Waits for connections there. `certificate`: nullptr without encryption.
  Web(const WebListen& listen, TlsContext certificate, const NetOptions& options);
  /// Only connects.
  explicit Web(const NetOptions& options);
  ~Web();
  Web(const Web&) = delete;
  Web& operator=(const Web&) = delete;

  /// Begins to connect; `opened` or `closed` follows.
  [[nodiscard]] WebLink* connect(const Address& address);
  /// What has happened, oldest first; false if nothing has. Never waits.
  [[nodiscard]] bool next(NetEvent& event);
  /// Readable while something has happened.
  [[nodiscard]] int descriptor() const;
  /// False if the link is not open any more. More than waits on a link at most breaks it.
  bool send(WebLink* link, const OutgoingMessage& message);
  /// Closes when all that was sent has left, or after a while; `closed` follows.
  void close(WebLink* link);
  /// Closes at once, without an event.
  void abandon(WebLink* link);

  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] static const std::string& host_of(const WebLink* link);
  [[nodiscard]] static const std::string& address_of(const WebLink* link);
  [[nodiscard]] static unsigned round_trip_ms(const WebLink* link);
  static void set_tag(WebLink* link, std::uintptr_t tag);
  [[nodiscard]] static std::uintptr_t tag(const WebLink* link);

  /// What GET /metrics answers. Who has shown nothing for a while is not healthy.
  void show(std::string metrics);
  /// For connections that begin from now on.
  void use(TlsContext certificate);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec::streaming
