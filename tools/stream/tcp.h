// TCP sockets as web.cpp needs them.
#pragma once

#include "transport.h"

#include <cstdint>
#include <string>

namespace gicodec::streaming {

/// A socket that waits for connections and never blocks; IPv6 where the address is, and with "::"
/// IPv4 too. Throws tools::Error of Exit::io.
[[nodiscard]] int listen_tcp(const Address& address);
[[nodiscard]] std::uint16_t port_of(int descriptor);

/// The other end of a connection.
struct TcpPeer {
  std::string address;  ///< "127.0.0.1:51022", "[2001:db8::1]:51022"
  /// What one stranger has at least one of: an IPv4 address, or a network of 64 bits of IPv6.
  std::string host;
  bool loopback = false;
};
/// A connection that waits to be taken and its other end; -1 if there is none. Without memory for
/// the latter it is closed, and std::bad_alloc thrown.
[[nodiscard]] int accept_tcp(int descriptor, TcpPeer& peer);

/// What the system knows of a connection.
struct TcpState {
  std::uint64_t read = 0;   ///< bytes taken from the socket so far, whatever they were
  std::uint64_t taken = 0;  ///< bytes that the other end has confirmed
  unsigned round_trip_ms = 0;
};
[[nodiscard]] TcpState tcp_state(int descriptor);

/// Lets the process open so many files at least; throws tools::Error of Exit::io if it may not.
void allow_files(std::size_t count);

}  // namespace gicodec::streaming
