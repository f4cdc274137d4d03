// Transports of the programs: addresses, limits, links and their events. ENet (enet.h) and
// WebSockets (web.h) carry whole messages in order, NATS (nats_receiver.h) tracks; net.h is all.
#pragma once

#include <gicodec/protocol.h>
#include <gicodec/track_receiver.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

struct _ENetPeer;  // NOLINT(*-reserved-identifier): ENet names it so

namespace gicodec::streaming {

enum class Via : std::uint8_t {
  enet,
  plain_web,  ///< WebSockets without encryption
  web,        ///< WebSockets over TLS
  nats,       ///< tracks over NATS; for clients
};

struct Address {
  std::string host;  ///< an address, IPv6 without brackets, or a name; of NATS the URLs
  std::uint16_t port = 0;
  Via via = Via::enet;
};
/// "127.0.0.1:4600", "[::1]:8443". Throws tools::Error of Exit::usage that names the flag.
[[nodiscard]] Address parse_address(const std::string& text, const char* flag);
/// The same with "wss://" or, only for this machine, "ws://" in front.
[[nodiscard]] Address parse_server(const std::string& text, const char* flag);
/// In the form of parse_server().
[[nodiscard]] std::string to_string(const Address& address);

/// Writes a file with the ports, one per line, for scripts; an empty path: none. Throws
/// tools::Error if the file exists and holds anything but ports.
void write_ports(const std::string& path, const std::vector<std::uint16_t>& ports);

struct WebLink;
class NatsReceiver;

/// A connection, valid until its `closed` event. At most one pointer is set.
struct Link {
  _ENetPeer* enet = nullptr;
  WebLink* web = nullptr;
  NatsReceiver* nats = nullptr;

  explicit operator bool() const { return enet != nullptr || web != nullptr || nats != nullptr; }
  friend bool operator==(const Link&, const Link&) = default;
};

struct NetEvent {
  enum class Type : std::uint8_t {
    opened,
    received,
    remark,   ///< `why` is for people
    renewed,  ///< another publisher is there: the client should say Hello
    broken,   ///< the peer broke a rule of the transport; see reason
    closed,
  };
  Type type{};
  Link link;
  Message message;
  Reason reason{};
  std::string why;     ///< closed: the cause, if known
  bool final = false;  ///< closed: another attempt would fail the same way
};

/// Connections that were closed unheard.
struct TurnedAway {
  std::uint64_t count = 0;    ///< for lack of room or memory
  std::string last;           ///< its address
  std::uint64_t origins = 0;  ///< because they came from pages that may not connect
  std::string last_origin;
};

/// How a client authenticates its server.
struct Trust {
  std::string ca;   ///< file of authorities; empty: the system's
  std::string pin;  ///< SHA-256 of the server's certificate, 32 bytes, instead of an authority
};

/// Where the servers of NATS are, and what to say to them.
struct NatsFlags {
  std::string urls;  ///< "nats://host:port", several with commas between; empty: NATS is not used
  std::string prefix = "gicodec";
  std::string user, password_file;
  std::string password;  ///< of that file
  std::string ca;        ///< file of authorities; empty: the system's
};

struct NetOptions {
  std::size_t links = 1;                              ///< at most, 1..4095
  std::size_t links_per_address = 4095;               ///< at most
  std::size_t max_received = std::size_t{256} << 20;  ///< bytes of a message
  std::size_t max_unsent = std::size_t{256} << 20;    ///< bytes queued on a link
  std::uint32_t window = std::uint32_t{1} << 20;      ///< bytes in flight per link
  double timeout = 5;       ///< seconds without an answer after which a link counts as lost
  double open_timeout = 5;  ///< seconds in which a link must open
  Trust trust;
  NatsFlags nats;                    ///< to connect to
  TrackReceiverOptions tracks = {};  ///< what to receive over it
};

/// The address for WebSockets, certificate and metrics.
struct WebListen {
  Address address;
  std::string certificate, key;  ///< PEM files; empty: no encryption
  std::string metrics_token;     ///< lets a reader see the metrics; empty: only this machine may
  std::string page = {};         ///< folder of a page that it serves; empty: none
  std::string scene = {};        ///< a glTF file that the page finds as scene.glb; empty: none
  std::vector<std::string> origins = {};  ///< whose pages may connect, besides its own; "*": all
  /// Connections from this machine come through a proxy, which says in X-Forwarded-For for whom.
  bool behind_proxy = false;
};

}  // namespace gicodec::streaming
