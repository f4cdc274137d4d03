// A WebSocket's connection: who may touch what of it. For web.cpp.
#pragma once

#include "tcp.h"
#include "transport.h"

#include <atomic>
#include <cstdint>
#include <deque>
#include <list>
#include <string>
#include <vector>

struct lws;

namespace gicodec::streaming {

/// Bytes in front of a message on its way out, for what frames it.
constexpr std::size_t kFrameRoom = 16;

struct Outgoing {
  std::vector<unsigned char> bytes;  ///< the message, with that room in front
  std::size_t done = 0;              ///< bytes of the message that have left
};

struct WebLink {
  // As it was made.
  TcpPeer peer;
  Address server;  ///< that a client connects to
  bool accepted = false;
  double since = 0;

  // The transport's thread.
  lws* wsi = nullptr;
  bool open = false, broken = false;
  double told = 0;       ///< when a server's last word left, the reason; 0: it has not
  bool trusted = false;  ///< the server's certificate was looked at, and found good
  std::string why;       ///< it is refused
  Message partial;       ///< message that arrives
  std::uint64_t payload = 0, messages = 0;  ///< received
  TcpState tcp;

  // Guarded by the transport's mutex.
  std::deque<Outgoing> unsent;
  std::size_t unsent_bytes = 0;
  std::size_t waiting = 0, waiting_bytes = 0;  ///< received, and not asked for yet
  bool closing = false, abandoned = false, gone = false;
  double closing_since = 0;

  // The caller's thread.
  std::uintptr_t tag = 0;

  std::atomic<unsigned> round_trip_ms = 0;
};

/// True if so much arrived beside messages that somebody means harm: pings, empty fragments,
/// messages in crumbs, records of nothing.
[[nodiscard]] bool floods(const WebLink& link, double now);

/// Connections that do not speak the protocol yet. There is always room for one more: it takes the
/// place of the oldest one of the addresses that have most of them, so that silence keeps nobody
/// out.
class HalfOpen {
 public:
  /// Returns the one that has to go for `link`, never `link` itself; nullptr if there is room. What
  /// it throws, std::bad_alloc, leaves everything as it was.
  [[nodiscard]] WebLink* add(WebLink* link);
  /// The oldest one of an address, which has to go for another one of it; nullptr if it has none.
  [[nodiscard]] WebLink* take(const std::string& host);
  void remove(WebLink* link) { links_.remove(link); }
  [[nodiscard]] const std::list<WebLink*>& all() const { return links_; }
  static constexpr std::size_t kMax = 64;

 private:
  std::list<WebLink*> links_;  ///< oldest first
};

}  // namespace gicodec::streaming
