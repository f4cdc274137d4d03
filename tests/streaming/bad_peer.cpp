// bad_peer KIND [ws://]ADDR:PORT: connects to a gi-server and misbehaves. Exit code 0 if the server
// ends the connection for the reason that the misbehaviour deserves, 1 if not, 2 for wrong usage.
#include "dump/error.h"
#include "stream/net.h"

#include <gicodec/protocol.h>

#include <arpa/inet.h>
#include <fmt/core.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <thread>

namespace {

using namespace gicodec;
using namespace gicodec::streaming;

constexpr double kPatience = 120;      ///< seconds; much more than the server's time-outs
constexpr std::size_t kVersionAt = 5;  // after type and magic number

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Message write(const AnyMessage& message) {
  Message bytes;
  tools::check(write_message(message, bytes), "message");
  return bytes;
}

Message noise(std::size_t size) {
  static std::mt19937 random(7);
  Message bytes(size);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

/// Any finite number, of all magnitudes alike.
float finite(std::mt19937& random) {
  while (true) {
    const auto value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (std::isfinite(value)) return value;
  }
}

/// Views that the protocol allows, whose numbers no camera has.
Viewpoint extreme_view(std::mt19937& random) {
  const auto position = [&] { return Position{finite(random), finite(random), finite(random)}; };
  Viewpoint view{position(), position(), position()};
  if (random() % 2 == 0) view.eye = {1, 1, 1};  // Within scenes: rays meet something.
  view.fov_y = std::min(std::abs(finite(random)) + 1e-38F, 179.9F);
  view.aspect = std::abs(finite(random)) + 1e-38F;
  view.time = finite(random);
  return view;
}

class Peer {
 public:
  explicit Peer(const Address& server) : net_(server.via, options()), link_(net_.connect(server)) {
    NetEvent event;
    const double end = now() + kPatience;
    while (now() < end) {
      if (net_.next(event, 50) && event.type == NetEvent::Type::opened) return;
    }
    tools::fail(tools::Exit::io, "no connection");
  }

  void send(const Message& message) { net_.send(link_, {message}); }
  void say(const AnyMessage& message) { send(write(message)); }
  void hello() {
    Hello hello;
    hello.sync = 1;
    say(hello);
  }

  /// Why the server ends the connection; nothing if it just ends, or does not.
  std::optional<Reason> reason(double seconds = kPatience) {
    NetEvent event;
    const double end = now() + seconds;
    while (now() < end) {
      if (!net_.next(event, 20)) continue;
      if (event.type == NetEvent::Type::closed) {
        open_ = false;
        return std::nullopt;
      }
      if (event.type != NetEvent::Type::received) continue;
      const auto message = read_message(event.message);
      if (!message) continue;
      if (const auto* goodbye = std::get_if<Goodbye>(&*message)) return goodbye->reason;
      welcome_ |= std::holds_alternative<Welcome>(*message);
      if (const auto* welcome = std::get_if<Welcome>(&*message); welcome && watches_) {
        const Grid g = welcome->volumes[0].geometry.grid;
        say(Subscribe{1, 0, 0, BlockMask(std::size_t{g.x} * g.y * g.z, 1)});
      }
    }
    return std::nullopt;
  }
  void watch() { watches_ = true; }
  [[nodiscard]] bool open() const { return open_; }
  [[nodiscard]] bool welcome() const { return welcome_; }

 private:
  static NetOptions options() {
    NetOptions options;
    options.timeout = kPatience;
    return options;
  }
  Net net_;
  Link link_;
  bool watches_ = false, open_ = true, welcome_ = false;
};

/// Something to do, and what the server is to say.
struct Kind {
  std::function<void(Peer&)> act;
  Reason expected;
};

const std::map<std::string, Kind>& kinds() {
  static const std::map<std::string, Kind> all{
      {"garbage", {[](Peer& p) { p.send(noise(500)); }, Reason::malformed}},
      {"late-garbage",
       {[](Peer& p) {
          p.hello();
          p.send(noise(5000));
        },
        Reason::malformed}},
      {"empty", {[](Peer& p) { p.send({}); }, Reason::malformed}},
      {"cut",
       {[](Peer& p) {
          Message hello = write(Hello{1});
          hello.pop_back();
          p.send(hello);
        },
        Reason::malformed}},
      {"version",
       {[](Peer& p) {
          Message hello = write(Hello{1});
          hello[kVersionAt] = std::byte{kProtocolVersion + 1};
          p.send(hello);
        },
        Reason::version}},
      {"token",
       {[](Peer& p) {
          Hello hello{1};
          hello.token = "not the token";
          p.say(hello);
        },
        Reason::token}},
      {"no-hello", {[](Peer& p) { p.say(Viewpoint{}); }, Reason::out_of_order}},
      {"replay",
       {[](Peer& p) {
          p.hello();
          p.hello();
        },
        Reason::out_of_order}},
      {"foreign-ticket-replay",
       {[](Peer& p) {
          Hello hello{1};
          hello.ticket.fill(std::byte{0x5A});
          p.say(hello);
          p.say(hello);
        },
        Reason::out_of_order}},
      {"server-message",
       {[](Peer& p) {
          p.hello();
          p.say(UpdateMessage{1, 1});
        },
        Reason::out_of_order}},
      {"future-sync",
       {[](Peer& p) {
          p.hello();
          p.say(Acknowledge{77, 1});
        },
        Reason::out_of_order}},
      {"future-update",
       {[](Peer& p) {
          p.hello();
          p.say(Acknowledge{1, 0x7FFFFFFF});
        },
        Reason::malformed}},
      {"unknown-volume",
       {[](Peer& p) {
          p.hello();
          p.say(Subscribe{1, 9, 0, BlockMask(8, 1)});
        },
        Reason::unknown_volume}},
      {"viewpoints",
       {[](Peer& p) {
          p.hello();
          std::mt19937 random(11);
          for (int i = 0; i < 100; ++i) {
            p.say(extreme_view(random));
            static_cast<void>(p.reason(0.02));
          }
          Message not_a_number = write(Viewpoint{});
          const auto bits =
              std::bit_cast<std::array<std::byte, 4>>(std::numeric_limits<float>::quiet_NaN());
          std::ranges::copy(bits, not_a_number.begin() + 1);
          p.send(not_a_number);
        },
        Reason::malformed}},
      {"flood",
       {[](Peer& p) {
          p.hello();
          for (int i = 0; i < 3000; ++i) p.say(Viewpoint{});
        },
        Reason::flood}},
      {"oversized",
       {[](Peer& p) { p.send(noise((std::size_t{1} << 20) + 1)); }, Reason::too_large}},
      {"silent", {[](Peer&) {}, Reason::silent}},
      {"never-acknowledges",
       {[](Peer& p) {
          p.hello();
          p.watch();
        },
        Reason::stalled}},
  };
  return all;
}

int misbehave(const std::string& name, const Kind& kind, const Address& server) {
  Peer peer(server);
  kind.act(peer);
  const std::optional<Reason> reason = peer.reason();
  const bool as_expected = reason == kind.expected;
  fmt::print("{}: {}{}\n", name,
             reason        ? std::string(to_string(*reason))
             : peer.open() ? "not dropped"
                           : "closed without a reason",
             as_expected ? "" : fmt::format(" INSTEAD OF {}", to_string(kind.expected)));
  return as_expected ? 0 : 1;
}

/// Begins a message beyond the transport's limit: no part of it may be taken.
int huge(const Address& server) {
  Peer peer(server);
  peer.hello();
  peer.send(noise(std::size_t{64} << 20));
  const auto reason = peer.reason(10);
  fmt::print("huge: {}\n", !peer.open() || !reason ? "not taken" : to_string(*reason));
  return 0;
}

/// Stops answering at all levels, as a machine that lost power.
int vanish(const Address& server) {
  Peer peer(server);
  peer.hello();
  peer.watch();
  const double end = now() + kPatience;
  while (!peer.welcome() && peer.open() && now() < end) static_cast<void>(peer.reason(0.2));
  static_cast<void>(peer.reason(0.5));
  std::this_thread::sleep_for(std::chrono::seconds(3));
  fmt::print("vanish: gone\n");
  return peer.welcome() ? 0 : 1;
}

/// Datagrams that are not even ENet's.
int datagrams(const Address& server) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(server.port);
  inet_pton(AF_INET, server.host.c_str(), &to.sin_addr);
  for (std::size_t i = 0; i < 5000; ++i) {
    const Message bytes = noise(1 + i % 1400);
    sendto(descriptor, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
  }
  ::close(descriptor);
  fmt::print("datagrams: sent\n");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "bad_peer: KIND [ws://]ADDR:PORT; kinds: huge vanish datagrams");
    for (const auto& [name, kind] : kinds()) fmt::print(stderr, " {}", name);
    fmt::print(stderr, "\n");
    return 2;
  }
  try {
    const std::string name = argv[1];
    const Address server = parse_server(argv[2], "address");
    if (name == "huge") return huge(server);
    if (name == "vanish") return vanish(server);
    if (name == "datagrams") return datagrams(server);
    const auto it = kinds().find(name);
    return it == kinds().end() ? 2 : misbehave(name, it->second, server);
  } catch (const std::exception& error) {
    fmt::print("{}: {}\n", argv[1], error.what());
    return 1;
  }
}
