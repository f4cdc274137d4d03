// ENet as the programs use it: one reliable, ordered channel of whole messages over UDP.
#pragma once

#include <gicodec/protocol.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

struct _ENetHost;  // NOLINT(*-reserved-identifier): ENet names it so
struct _ENetPeer;  // NOLINT(*-reserved-identifier)

namespace gicodec::streaming {

struct Address {
  std::string host;  ///< IPv4 address or a name
  std::uint16_t port = 0;
};
/// "127.0.0.1:4600". Throws tools::Error of Exit::usage that names the flag.
[[nodiscard]] Address parse_address(const std::string& text, const char* flag);

/// A file with the port in it, for scripts; nothing for an empty path. Throws tools::Error if the
/// file holds anything but a port.
void write_port(const std::string& path, std::uint16_t port);

using Link = _ENetPeer*;  ///< valid until its `closed` event

struct NetEvent {
  enum class Kind : std::uint8_t { opened, received, closed };
  Kind kind{};
  Link link = nullptr;
  Message message;
};

struct NetOptions {
  std::size_t links = 1;                                            ///< at most, 1..4095
  std::size_t links_per_address = 4095;                             ///< at most
  std::size_t max_received = std::size_t{256} << 20;                ///< bytes of a message
  std::uint32_t window = std::uint32_t{1} << 20;                    ///< bytes under way per link
  std::uint32_t bytes_per_second_in = 0, bytes_per_second_out = 0;  ///< 0: no limit
  double timeout = 5;  ///< seconds without an answer after which a link counts as lost
};

/// A UDP socket and its links. Everything on one thread; throws tools::Error of Exit::io.
class Net {
 public:
  /// Waits for connections on this address.
  Net(const Address& listen, const NetOptions& options);
  /// Only connects.
  explicit Net(const NetOptions& options);
  ~Net();
  Net(const Net&) = delete;
  Net& operator=(const Net&) = delete;

  /// Begins to connect; `opened` or `closed` follows.
  [[nodiscard]] Link connect(const Address& address);
  /// Sends and receives for at most so long; false if nothing happened.
  [[nodiscard]] bool next(NetEvent& event, unsigned milliseconds);
  /// False if the link is not open any more.
  bool send(Link link, const Message& message);
  /// Puts what is queued on the wire without waiting for next().
  void flush();
  /// Closes when all that was sent has arrived; `closed` follows.
  void close(Link link);
  /// Closes at once, without an event.
  void abandon(Link link);

  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] static std::string address_of(Link link);  ///< "127.0.0.1:51022"
  [[nodiscard]] static unsigned round_trip_ms(Link link);

  /// A number of the caller's that belongs to the link; 0 at first.
  static void set_tag(Link link, std::uintptr_t tag);
  [[nodiscard]] static std::uintptr_t tag(Link link);

 private:
  struct Library;
  void prepare_host();
  void prepare(Link link) const;

  std::shared_ptr<Library> library_;
  NetOptions options_;
  _ENetHost* host_ = nullptr;
};

}  // namespace gicodec::streaming
