// TCP sockets for web.cpp.
#pragma once

#include "transport.h"

#include <cstdint>
#include <string>

namespace gicodec::streaming {

/// A non-blocking socket that listens at an address, IPv4 or IPv6; "::" listens for both. Throws
/// tools::Error of Exit::io.
[[nodiscard]] int listen_tcp(const Address& address);
[[nodiscard]] std::uint16_t port_of(int descriptor);

/// The other end of a connection.
struct TcpPeer {
  std::string address;  ///< "127.0.0.1:51022", "[2001:db8::1]:51022"
  /// The origin: an IPv4 address, or an IPv6 network of 64 bits.
  std::string host;
  bool loopback = false;
};
/// The peer of a text that is nothing but an address, with that port; no host for any other text.
[[nodiscard]] TcpPeer peer_from_string(const std::string& text, std::uint16_t port);
/// Accepts a waiting connection, and sets its peer; -1 if there is none. Without memory for `peer`
/// it closes the connection and throws std::bad_alloc.
[[nodiscard]] int accept_tcp(int descriptor, TcpPeer& peer);

/// True if the other end of a connection is on this machine.
[[nodiscard]] bool peer_is_here(int descriptor) noexcept;

/// The system's counters of a connection.
struct TcpState {
  std::uint64_t read = 0;   ///< bytes read from the socket so far
  std::uint64_t taken = 0;  ///< bytes that the peer has confirmed
  unsigned round_trip_ms = 0;
};
[[nodiscard]] TcpState tcp_state(int descriptor);

/// Lets the process open at least `count` files. Throws tools::Error of Exit::io.
void allow_files(std::size_t count);

}  // namespace gicodec::streaming
