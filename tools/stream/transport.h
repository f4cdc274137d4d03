// What the programs' transports have in common: addresses, limits, links and what happens on them.
// Each carries whole messages in order, over ENet (enet.h) or WebSockets (web.h); net.h is both.
#pragma once

#include <gicodec/protocol.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

struct _ENetPeer;  // NOLINT(*-reserved-identifier): ENet names it so

namespace gicodec::streaming {

enum class Via : std::uint8_t {
  enet,
  plain_web,  ///< WebSockets that anybody on the way can read
  web,        ///< WebSockets over TLS
};

struct Address {
  std::string host;  ///< an address, IPv6 without brackets, or a name
  std::uint16_t port = 0;
  Via via = Via::enet;
};
/// "127.0.0.1:4600", "[::1]:8443". Throws tools::Error of Exit::usage that names the flag.
[[nodiscard]] Address parse_address(const std::string& text, const char* flag);
/// The same with "wss://" or, to this machine itself, "ws://" in front.
[[nodiscard]] Address parse_server(const std::string& text, const char* flag);
/// As parse_server() takes it.
[[nodiscard]] std::string to_string(const Address& address);
/// True if it names this machine itself: 127.0.0.0/8, ::1 or localhost.
[[nodiscard]] bool is_loopback(const std::string& host);

/// A file with the ports in it, a line each, for scripts; nothing for an empty path. Throws
/// tools::Error if the file holds anything but ports.
void write_ports(const std::string& path, const std::vector<std::uint16_t>& ports);

struct WebLink;

/// A connection, valid until its `closed` event; one of the pointers at most.
struct Link {
  _ENetPeer* enet = nullptr;
  WebLink* web = nullptr;

  explicit operator bool() const { return enet != nullptr || web != nullptr; }
  friend bool operator==(const Link&, const Link&) = default;
};

struct NetEvent {
  enum class Type : std::uint8_t {
    opened,
    received,
    broken,  ///< the peer broke a rule of the transport's; see reason
    closed,
  };
  Type type{};
  Link link;
  Message message;
  Reason reason{};
  std::string why;     ///< closed: what is known of it, if anything is
  bool final = false;  ///< closed: another try would end the same way
};

/// By what a client knows its server.
struct Trust {
  std::string ca;   ///< file of authorities; empty: the system's
  std::string pin;  ///< SHA-256 of the server's certificate, 32 bytes, in place of an authority
};

struct NetOptions {
  std::size_t links = 1;                              ///< at most, 1..4095
  std::size_t links_per_address = 4095;               ///< at most
  std::size_t max_received = std::size_t{256} << 20;  ///< bytes of a message
  std::size_t max_unsent = std::size_t{256} << 20;    ///< bytes that wait on a link
  std::uint32_t window = std::uint32_t{1} << 20;      ///< bytes under way per link
  double timeout = 5;       ///< seconds without an answer after which a link counts as lost
  double open_timeout = 5;  ///< seconds in which one has to come about
  Trust trust;
};

/// Where WebSockets are listened for, and with what.
struct WebListen {
  Address address;
  std::string certificate, key;  ///< PEM files; none for what is not encrypted
  std::string metrics_token;     ///< who shows it may read the metrics; empty: this machine
};

}  // namespace gicodec::streaming
