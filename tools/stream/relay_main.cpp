// gi-relay: a bad network between gi-client and gi-server: drops, delays, shuffles and limits UDP
// packets.
#include "clock.h"
#include "common/program.h"
#include "dump/error.h"
#include "dump/text.h"
#include "log.h"
#include "transport.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <map>
#include <queue>
#include <random>
#include <utility>
#include <vector>

namespace {

using namespace gicodec;
using streaming::Address;
using streaming::now;
using tools::Exit;
using tools::fail;

constexpr std::size_t kLargest = 65536;                  ///< bytes of a UDP packet, and more
constexpr std::size_t kMaxQueue = std::size_t{8} << 20;  ///< bytes that wait in one direction
constexpr std::size_t kMaxClients = 4096;
constexpr double kMaxWait = 0.05;  ///< seconds between looks at signals

constexpr const char* kExitCodes =
    "Exit codes:\n"
    "  0  success\n"
    "  2  the command line makes no sense\n"
    "  4  the address cannot be listened to, or a file or standard output cannot be written\n"
    "  5  an internal error, or memory ran out";

struct Options {
  std::string listen = "127.0.0.1:0", to, port_file;
  double loss = 0, delay = 0, jitter = 0, rate_limit = 0, seconds = 0;
  std::uint64_t seed = 1;
  bool quiet = false;
};

class Socket {
 public:
  Socket() : descriptor_(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    if (descriptor_ < 0) fail(Exit::io, "a socket cannot be opened: {}", std::strerror(errno));
    const int bytes = 4 << 20;
    setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    setsockopt(descriptor_, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  }
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Socket& operator=(Socket&&) = delete;
  ~Socket() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  [[nodiscard]] int get() const { return descriptor_; }

 private:
  int descriptor_;
};

sockaddr_in resolve(const Address& address, const char* flag) {
  sockaddr_in resolved{};
  resolved.sin_family = AF_INET;
  resolved.sin_port = htons(address.port);
  if (inet_pton(AF_INET, address.host.c_str(), &resolved.sin_addr) != 1)
    fail(Exit::usage, "{}: {} is no IPv4 address", flag, address.host);
  return resolved;
}

/// True if packets sent to `to` arrive at a socket listening at `listening`.
bool reaches(const sockaddr_in& to, const sockaddr_in& listening) {
  constexpr std::uint32_t kLoopback = 127;
  const bool any = listening.sin_addr.s_addr == htonl(INADDR_ANY) &&
                   ntohl(to.sin_addr.s_addr) >> 24 == kLoopback;
  return to.sin_port == listening.sin_port &&
         (any || to.sin_addr.s_addr == listening.sin_addr.s_addr);
}

/// A delayed packet.
struct Packet {
  double due = 0;
  std::uint64_t number = 0;  ///< keeps the order of packets due at the same time
  int socket = -1;
  sockaddr_in to{};
  bool upward = false;
  std::vector<std::byte> bytes;
  friend bool operator>(const Packet& a, const Packet& b) {
    return std::pair(a.due, a.number) > std::pair(b.due, b.number);
  }
};

/// One direction of the path.
struct Direction {
  std::uint64_t passed = 0, dropped = 0;
  std::size_t waiting = 0;  ///< bytes
  double free_at = 0;       ///< when the rate limit admits the next packet
};

class Relay {
 public:
  explicit Relay(const Options& options)
      : options_(options),
        server_(resolve(streaming::parse_address(options.to, "--to"), "--to")),
        random_(options.seed) {
    if (server_.sin_port == 0)
      fail(Exit::usage, "--to {}: a server has a port of 1 to 65535", options.to);
    const Address listen = streaming::parse_address(options.listen, "--listen");
    sockaddr_in address = resolve(listen, "--listen");
    if (reaches(server_, address))
      fail(Exit::usage, "--to {} is where it listens itself; name the server's port", options.to);
    socklen_t size = sizeof address;
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    if (bind(front_.get(), generic, size) != 0 || getsockname(front_.get(), generic, &size) != 0)
      fail(Exit::io, "{}: cannot be listened to: {}", options.listen, std::strerror(errno));
    const std::uint16_t port = ntohs(address.sin_port);
    streaming::write_ports(options.port_file, {port});
    if (!options.quiet) streaming::log_line("gi-relay: {}:{} to {}", listen.host, port, options.to);
  }

  void run() {
    const double end = options_.seconds > 0 ? now() + options_.seconds : 1e300;
    while (!tools::interrupted() && now() < end) {
      wait();
      receive_all();
      send_due();
    }
    if (options_.quiet) return;
    for (const bool upward : {true, false}) {
      const Direction& d = directions_[upward ? 1 : 0];
      tools::print("{}: {} packets passed, {} dropped\n", upward ? "to the server" : "to clients",
                   d.passed, d.dropped);
    }
  }

 private:
  void wait() {
    std::vector<pollfd> polled{{front_.get(), POLLIN, 0}};
    for (const auto& [client, socket] : backs_) polled.push_back({socket.get(), POLLIN, 0});
    const double left =
        packets_.empty() ? kMaxWait : std::clamp(packets_.top().due - now(), 0.0, kMaxWait);
    const timespec timeout{0, static_cast<long>(left * 1e9)};
    ppoll(polled.data(), polled.size(), &timeout, nullptr);
  }

  void receive_all() {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    ssize_t got = 0;
    auto* const generic = reinterpret_cast<sockaddr*>(&from);
    while ((got = recvfrom(front_.get(), buffer_.data(), buffer_.size(), 0, generic, &size)) >= 0) {
      const std::uint64_t client = std::uint64_t{from.sin_addr.s_addr} << 16 | from.sin_port;
      auto it = backs_.find(client);
      if (it == backs_.end() && backs_.size() < kMaxClients) {
        it = backs_.emplace(client, Socket()).first;
        clients_[client] = from;
      }
      if (it != backs_.end()) take(static_cast<std::size_t>(got), it->second.get(), server_, true);
      size = sizeof from;
    }
    for (const auto& [client, socket] : backs_) {
      while ((got = recv(socket.get(), buffer_.data(), buffer_.size(), 0)) >= 0) {
        take(static_cast<std::size_t>(got), front_.get(), clients_[client], false);
      }
    }
  }

  /// Drops, delays or queues a packet.
  void take(std::size_t bytes, int socket, const sockaddr_in& to, bool upward) {
    Direction& d = directions_[upward ? 1 : 0];
    const double draw = std::uniform_real_distribution(0.0, 100.0)(random_);
    if (draw < options_.loss || d.waiting + bytes > kMaxQueue) {
      ++d.dropped;
      return;
    }
    double due = now();
    if (options_.rate_limit > 0) {
      due = std::max(due, d.free_at) + static_cast<double>(bytes) * 8e-6 / options_.rate_limit;
      d.free_at = due;
    }
    due += options_.delay * 1e-3;
    if (options_.jitter > 0)
      due += std::uniform_real_distribution(0.0, options_.jitter * 1e-3)(random_);
    const std::byte* const data = buffer_.data();
    packets_.push({due, next_++, socket, to, upward, {data, data + bytes}});
    d.waiting += bytes;
    ++d.passed;
  }

  void send_due() {
    while (!packets_.empty() && packets_.top().due <= now()) {
      const Packet& packet = packets_.top();
      sendto(packet.socket, packet.bytes.data(), packet.bytes.size(), 0,
             reinterpret_cast<const sockaddr*>(&packet.to), sizeof packet.to);
      directions_[packet.upward ? 1 : 0].waiting -= packet.bytes.size();
      packets_.pop();
    }
  }

  const Options& options_;
  sockaddr_in server_;
  std::mt19937_64 random_;
  Socket front_;                                  ///< that clients send to
  std::map<std::uint64_t, Socket> backs_;         ///< towards the server, one for each client
  std::map<std::uint64_t, sockaddr_in> clients_;  ///< their addresses
  Direction directions_[2];
  std::priority_queue<Packet, std::vector<Packet>, std::greater<>> packets_;
  std::uint64_t next_ = 0;
  std::vector<std::byte> buffer_ = std::vector<std::byte>(kLargest);
};

}  // namespace

int main(int argc, char** argv) {
  tools::Command app{"Passes UDP packets on as a bad network does, for trying out gi-server.",
                     "gi-relay"};
  Options o;
  app.add_option("--listen", o.listen, "Where clients connect to; port 0: any free one")
      ->type_name("ADDR:PORT")
      ->show_default();
  app.add_option("--to", o.to, "The server, by its IPv4 address")
      ->type_name("ADDR:PORT")
      ->required();
  app.add_option("--port-file", o.port_file, "Write the port to a file")->type_name("FILE");
  app.add_option("--loss", o.loss, "Per cent of packets that are lost, each way")
      ->allow(tools::in_range(0.0, 100.0));
  app.add_option("--delay", o.delay, "Milliseconds, each way")
      ->allow(tools::in_range(0.0, 60000.0));
  app.add_option("--jitter", o.jitter, "Milliseconds that are added by chance; changes the order")
      ->allow(tools::in_range(0.0, 60000.0));
  app.add_option("--rate-limit", o.rate_limit,
                 "Mbps each way; up to 8 MiB wait, what is beyond is lost")
      ->allow(tools::in_range(0.0, 1e6));
  app.add_option("--seed", o.seed, "Of chance")
      ->allow(tools::in_range(0, std::numeric_limits<int>::max()))
      ->show_default();
  app.add_option("--seconds", o.seconds, "Ends after so long; 0: when interrupted")
      ->allow(tools::in_range(0.0, 1e9));
  app.add_flag("-q,--quiet", o.quiet,
               "Nothing but errors; else packets passed and dropped are printed at the end");
  app.footer(
      fmt::format("{}\n\nExamples:\n"
                  "  gi-relay --listen 127.0.0.1:4700 --to 127.0.0.1:4600 --loss 5 --delay "
                  "50 --jitter 20\n",
                  kExitCodes));
  return tools::run_program(app, argc, argv, [&] {
    Relay(o).run();
    return Exit::ok;
  });
}
