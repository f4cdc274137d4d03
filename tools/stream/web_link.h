// A WebSocket connection, and which thread may use which of its members. For web.cpp.
#pragma once

#include "tcp.h"
#include "transport.h"
#include "web_page.h"

#include <atomic>
#include <cstdint>
#include <deque>
#include <list>
#include <string>
#include <vector>

struct lws;

namespace gicodec::streaming {

/// Bytes in front of an outgoing message, for the header of its frame.
constexpr std::size_t kFrameRoom = 16;

struct Outgoing {
  std::vector<unsigned char> bytes;  ///< the message behind kFrameRoom bytes
  std::size_t done = 0;              ///< bytes of the message that have left
};

struct WebLink {
  // Set at creation.
  TcpPeer peer;
  Address server;  ///< that a client connects to
  bool accepted = false;
  double created = 0;  ///< when

  // The transport's thread.
  lws* wsi = nullptr;
  bool open = false, broken = false;
  double goodbye_sent = 0;                  ///< when the server's reason left; 0: it has not
  bool trusted = false;                     ///< the server's certificate was verified
  std::string why;                          ///< reason to refuse the server
  Message partial;                          ///< the incomplete message that is arriving
  std::uint64_t payload = 0, messages = 0;  ///< received
  TcpState tcp;
  WebAnswer page;  ///< to a plain request: what has not left
  bool answering = false;

  // Guarded by the transport's mutex.
  std::list<NetEvent> last = std::list<NetEvent>(1);  ///< memory for the event of its end
  std::deque<Outgoing> unsent;
  std::size_t unsent_bytes = 0;
  std::size_t waiting = 0, waiting_bytes = 0;  ///< received, and not taken yet
  bool closing = false, abandoned = false, gone = false;
  double closing_since = 0;

  // The caller's thread.
  std::uintptr_t tag = 0;

  std::atomic<unsigned> round_trip_ms = 0;
};

/// True if the peer sends far more bytes than its messages need, as an attack: pings, empty or tiny
/// fragments, empty records.
[[nodiscard]] bool floods(const WebLink& link, double now);

/// Connections that have not begun the protocol. A further one replaces the oldest of the address
/// with most of them, so that silent connections keep no client out.
class HalfOpen {
 public:
  /// Adds `link`. Returns the connection to close for it, never `link` itself; nullptr if there is
  /// room. std::bad_alloc changes nothing.
  [[nodiscard]] WebLink* add(WebLink* link);
  /// Removes and returns the oldest connection of an address; nullptr if it has none.
  [[nodiscard]] WebLink* take(const std::string& host);
  void remove(WebLink* link) { links_.remove(link); }
  [[nodiscard]] const std::list<WebLink*>& all() const { return links_; }
  static constexpr std::size_t kMax = 64;

 private:
  std::list<WebLink*> links_;  ///< oldest first
};

}  // namespace gicodec::streaming
