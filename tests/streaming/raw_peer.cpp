// raw_peer KIND ADDR:PORT: speaks ENet to a gi-server as no client does. Exit code 0 when all was
// sent, whatever the server makes of it, 1 if there is no connection, 2 for wrong usage.
#include "dump/error.h"
#include "stream/transport.h"

#include <gicodec/protocol.h>

#include <enet/enet.h>
#include <fmt/core.h>

#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace gicodec;

/// Who left without a word keeps a place until its time-out, and ENet asks for one ever more
/// rarely: as gi-client does, each attempt asks from another port.
constexpr unsigned kWait = 4000;  ///< milliseconds of an attempt
constexpr int kAttempts = 30;
constexpr unsigned kStay = 50;  ///< for what the server says in between

std::mt19937 random_source(11);

struct DestroyHost {
  void operator()(ENetHost* host) const { enet_host_destroy(host); }
};

class RawPeer {
 public:
  RawPeer(const streaming::Address& server, std::size_t channels) {
    ENetAddress address{};
    address.port = server.port;
    if (enet_address_set_host(&address, server.host.c_str()) != 0) fail();
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      host_.reset(enet_host_create(nullptr, 1, channels, 0, 0));
      if (!host_) fail();
      peer_ = enet_host_connect(host_.get(), &address, channels, 0xFFFFFFFF);
      ENetEvent event{};
      if (peer_ != nullptr && enet_host_service(host_.get(), &event, kWait) > 0 &&
          event.type == ENET_EVENT_TYPE_CONNECT) {
        return;
      }
    }
    fail();
  }

  void send(const Message& bytes, std::uint8_t channel, unsigned flags) {
    ENetPacket* const packet = enet_packet_create(bytes.data(), bytes.size(), flags);
    if (enet_peer_send(peer_, channel, packet) != 0) enet_packet_destroy(packet);
  }
  /// What the server sends is thrown away.
  void look(unsigned milliseconds = kStay) {
    ENetEvent event{};
    while (enet_host_service(host_.get(), &event, milliseconds) > 0) {
      if (event.type == ENET_EVENT_TYPE_RECEIVE) enet_packet_destroy(event.packet);
      if (event.type == ENET_EVENT_TYPE_DISCONNECT) return;
    }
  }

 private:
  [[noreturn]] static void fail() { tools::fail(tools::Exit::io, "no connection"); }

  std::unique_ptr<ENetHost, DestroyHost> host_;
  ENetPeer* peer_ = nullptr;
};

Message noise(std::size_t size) {
  Message bytes(size);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random_source());
  return bytes;
}

std::vector<Message> sound_messages() {
  Hello hello;
  hello.sync = 1;
  const AnyMessage all[] = {hello,
                            Resync{2, 1, {}},
                            Acknowledge{1, 1},
                            Viewpoint{},
                            Subscribe{1, 0, 0, BlockMask(108, 1)},
                            Goodbye{}};
  std::vector<Message> messages;
  for (const AnyMessage& one : all) {
    tools::check(write_message(one, messages.emplace_back()), "message");
  }
  return messages;
}

/// Bytes of a sound message changed, cut or added.
Message mutated(Message message) {
  for (unsigned n = random_source() % 4; n > 0; --n) {
    if (message.empty()) break;
    message[random_source() % message.size()] = static_cast<std::byte>(random_source());
  }
  switch (random_source() % 3) {
    case 0:
      message.resize(random_source() % (message.size() + 1));
      break;
    case 1:
      message.resize(message.size() + random_source() % 40);
      break;
    default:
      break;
  }
  return message;
}

/// Unreliable, unsequenced and fragmented packets, on channels that are not the protocol's.
void transports(const streaming::Address& server) {
  RawPeer peer(server, 255);
  for (const unsigned flags :
       {0U, unsigned{ENET_PACKET_FLAG_UNSEQUENCED}, unsigned{ENET_PACKET_FLAG_UNRELIABLE_FRAGMENT},
        unsigned{ENET_PACKET_FLAG_RELIABLE}}) {
    for (const unsigned channel : {0U, 1U, 200U}) {
      for (const unsigned size : {0U, 1U, 1300U, 30000U})
        peer.send(noise(size), static_cast<std::uint8_t>(channel), flags);
    }
  }
  peer.look();
}

/// A Hello, and then messages that begin as good ones do.
void mutants(const streaming::Address& server) {
  const auto sound = sound_messages();
  for (int connection = 0; connection < 60; ++connection) {
    RawPeer peer(server, 1);
    if (connection % 4 != 0) peer.send(sound.front(), 0, ENET_PACKET_FLAG_RELIABLE);
    for (int i = 0; i < 30; ++i) {
      peer.send(mutated(sound[random_source() % sound.size()]), 0, ENET_PACKET_FLAG_RELIABLE);
    }
    peer.look(20);
  }
}

/// Comes, is dropped, comes again; each time leaves the connection to the server. More often than
/// the server's log has lines for, 500 and 10 a second, however slow the machine is.
void crowds(const streaming::Address& server) {
  const auto begin = std::chrono::steady_clock::now();
  const auto lines = [&] {
    return 540 +
           11 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  for (int connection = 0; connection < 5000 && connection < lines(); ++connection) {
    RawPeer peer(server, 1);
    peer.send(noise(40), 0, ENET_PACKET_FLAG_RELIABLE);
    peer.look(0);
    peer.look(1);
  }
}

const std::map<std::string, std::function<void(const streaming::Address&)>> kKinds{
    {"transports", transports}, {"mutants", mutants}, {"crowds", crowds}};

}  // namespace

int main(int argc, char** argv) {
  const auto kind = argc == 3 ? kKinds.find(argv[1]) : kKinds.end();
  if (kind == kKinds.end()) {
    fmt::print(stderr, "raw_peer: KIND ADDR:PORT; kinds: transports mutants crowds\n");
    return 2;
  }
  try {
    if (enet_initialize() != 0) return 1;
    kind->second(streaming::parse_address(argv[2], "address"));
    enet_deinitialize();
    return 0;
  } catch (const std::exception& error) {
    fmt::print("{}: {}\n", argv[1], error.what());
    return 1;
  }
}
