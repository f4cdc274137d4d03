// ENet: one reliable, ordered channel of whole messages over UDP.
#pragma once

#include "transport.h"

#include <memory>

struct _ENetHost;  // NOLINT(*-reserved-identifier)

namespace gicodec::streaming {

/// A UDP socket and its links. One thread; throws tools::Error of Exit::io.
class Enet {
 public:
  using Link = _ENetPeer*;

  /// Waits for connections on this address.
  Enet(const Address& listen, const NetOptions& options);
  /// Only connects.
  explicit Enet(const NetOptions& options);
  ~Enet();
  Enet(const Enet&) = delete;
  Enet& operator=(const Enet&) = delete;

  /// Begins to connect; `opened` or `closed` follows.
  [[nodiscard]] Link connect(const Address& address);
  /// Sends and receives for at most so long; false if nothing happened.
  [[nodiscard]] bool next(NetEvent& event, unsigned milliseconds);
  /// Readable when something has arrived.
  [[nodiscard]] int descriptor() const;
  /// False if the link is not open any more.
  bool send(Link link, const OutgoingMessage& message);
  /// Confirms packets that have arrived; next() returns them later.
  void attend();
  /// Puts what is queued on the wire without waiting for next().
  void flush();
  /// Closes the link once all messages have arrived; `closed` follows.
  void close(Link link);
  /// Closes at once, without an event.
  void abandon(Link link);

  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] static std::string host_of(Link link);     ///< "127.0.0.1"
  [[nodiscard]] static std::string address_of(Link link);  ///< "127.0.0.1:51022"
  [[nodiscard]] static unsigned round_trip_ms(Link link);

  /// Sets the caller's number of the link; 0 at first.
  static void set_tag(Link link, std::uintptr_t tag);
  [[nodiscard]] static std::uintptr_t tag(Link link);

 private:
  struct Library;
  void prepare_host();
  void tend();
  void prepare(Link link) const;

  std::shared_ptr<Library> library_;
  NetOptions options_;
  _ENetHost* host_ = nullptr;
  std::uint32_t tended_ = 0;  ///< ENet's time, milliseconds
};

}  // namespace gicodec::streaming
