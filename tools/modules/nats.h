// What the module gicodec-nats offers: a connection to NATS servers, by libnats.
#pragma once

#include "modules/module.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gicodec::tools {

struct NatsOptions {
  std::vector<std::string> urls;  ///< nats://host:port or tls://host:port, tried in this order
  std::string name;               ///< of this program, for operators
  std::string user, password;     ///< empty: none
  std::string ca;                 ///< file of authorities to trust; empty: the system's
  double timeout = 2;             ///< seconds to connect, more after failed attempts, and to write
  std::size_t max_unsent = std::size_t{64} << 20;     ///< bytes that publish() may queue
  std::size_t max_received = std::size_t{256} << 20;  ///< bytes that wait for next()
};

struct NatsMessage {
  std::uint64_t subscription = 0;  ///< of a received one
  std::string subject = {}, reply = {};
  std::vector<std::pair<std::string, std::string>> headers = {};
  std::vector<std::byte> data = {};
  /// Of a received one: "503" if there was nobody to answer, "404" if there is no such message.
  std::string status = {};
  std::uint64_t sequence = 0;  ///< in the stream it was fetched from; 0: unknown
};

struct NatsState {
  bool connected = false;
  std::uint64_t connections = 0;  ///< made so far, the first one included
  std::string failure;  ///< why it is not connected, or what the server refused last; not escaped
  bool final = false;   ///< it will not connect any more
  std::size_t max_payload = 0;  ///< bytes of a message, by the last server
  std::uint64_t dropped = 0;    ///< received messages that next() was too slow for
};

/// Connects, and again after a loss, on threads of its own. The calls are for one thread.
class NatsConnection {
 public:
  virtual ~NatsConnection() = default;
  /// The number of the subscription, which outlives lost connections; 0: memory ran out.
  virtual std::uint64_t subscribe(const std::string& subject) = 0;
  virtual void unsubscribe(std::uint64_t subscription) = 0;
  /// False if too much is queued, or memory ran out. What is queued when a connection is lost may
  /// or may not arrive.
  virtual bool publish(NatsMessage&& message) = 0;
  /// Waits for at most so long; false if nothing came.
  virtual bool next(NatsMessage& message, unsigned milliseconds) = 0;
  [[nodiscard]] virtual NatsState state() = 0;
  /// A subject for answers to this connection alone; append "." and a name.
  [[nodiscard]] virtual const std::string& inbox() const noexcept = 0;
};

struct NatsModule {
  ModuleHead head;
  /// Null if memory ran out.
  std::unique_ptr<NatsConnection> (*open)(const NatsOptions& options);
};

/// Loaded at the first call; throws Error of Exit::internal if that fails.
[[nodiscard]] const NatsModule& nats_module();

}  // namespace gicodec::tools
