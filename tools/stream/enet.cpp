#include "enet.h"

#include "dump/error.h"

#include <enet/enet.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;

/// ENet checks the size of what is sent against the limit of what is received.
constexpr std::size_t kMaxSent = std::size_t{1} << 30;
constexpr std::uint32_t kMilliseconds = 1000;
/// Receive buffer in bytes, as far as the system allows. While an update is made, packets beyond it
/// are lost and must be sent again.
constexpr int kSocketBuffer = 4 << 20;

ENetAddress resolve(const Address& address) {
  ENetAddress resolved{};
  resolved.port = address.port;
  if (enet_address_set_host(&resolved, address.host.c_str()) != 0) {
    fail(Exit::io, "{}: is no address that is known here", address.host);
  }
  return resolved;
}

}  // namespace

struct Enet::Library {
  Library() {
    if (enet_initialize() != 0) fail(Exit::io, "the network library cannot be started");
  }
  ~Library() { enet_deinitialize(); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

Enet::Enet(const Address& listen, const NetOptions& options)
    : library_(std::make_shared<Library>()), options_(options) {
  const ENetAddress address = resolve(listen);
  host_ = enet_host_create(&address, options.links, 1, 0, 0);
  if (host_ == nullptr) {
    fail(Exit::io, "{}:{}: cannot be listened to: {}", listen.host, listen.port,
         std::strerror(errno));
  }
  host_->duplicatePeers = options.links_per_address;
  prepare_host();
}

Enet::Enet(const NetOptions& options) : library_(std::make_shared<Library>()), options_(options) {
  host_ = enet_host_create(nullptr, options.links, 1, 0, 0);
  if (host_ == nullptr) fail(Exit::io, "a UDP socket cannot be opened");
  prepare_host();
}

void Enet::prepare_host() {
  host_->maximumPacketSize = host_->maximumWaitingData = options_.max_received;
  for (const ENetSocketOption buffer : {ENET_SOCKOPT_RCVBUF, ENET_SOCKOPT_SNDBUF}) {
    static_cast<void>(enet_socket_set_option(host_->socket, buffer, kSocketBuffer));
  }
}

Enet::~Enet() { enet_host_destroy(host_); }

Enet::Link Enet::connect(const Address& address) {
  const ENetAddress to = resolve(address);
  const Link link = enet_host_connect(host_, &to, 1, 0);
  if (link == nullptr) fail(Exit::io, "{}: too many connections", address.host);
  set_tag(link, 0);
  return link;
}

/// ENet's window of 64 KiB allows only a few Mbps on long paths, and its throttle closes where
/// delays vary. NetOptions::window limits the bytes in flight instead.
void Enet::prepare(Link link) const {
  link->windowSize = options_.window;
  link->packetThrottleAcceleration = ENET_PEER_PACKET_THROTTLE_SCALE;
  link->packetThrottleDeceleration = 0;
  const auto least = static_cast<std::uint32_t>(std::lround(options_.timeout * kMilliseconds));
  // Any answer restarts the time-out, however long the path.
  enet_peer_timeout(link, 1, least, least);
}

/// Frees the places of peers that did not finish connecting, which ENet keeps for half a minute,
/// and sets the window again, which ENet resets whenever a peer comes or goes.
void Enet::tend() {
  constexpr std::uint32_t kMax = 2000, kEvery = 100;  // milliseconds
  const std::uint32_t now = enet_time_get();
  if (now - tended_ < kEvery) return;
  tended_ = now;
  for (std::size_t i = 0; i < host_->peerCount; ++i) {
    ENetPeer& peer = host_->peers[i];
    if (peer.state == ENET_PEER_STATE_ACKNOWLEDGING_CONNECT) {
      enet_peer_timeout(&peer, 1, kMax, kMax);
    } else if (peer.state == ENET_PEER_STATE_CONNECTED) {
      peer.windowSize = options_.window;
    }
  }
}

bool Enet::next(NetEvent& event, unsigned milliseconds) {
  tend();
  ENetEvent got{};
  const int result = enet_host_service(host_, &got, milliseconds);
  // An interrupted wait is no failure: the caller checks for signals.
  if (result <= 0 || got.type == ENET_EVENT_TYPE_NONE) return false;
  event = {};
  event.link = {got.peer, nullptr};
  switch (got.type) {
    case ENET_EVENT_TYPE_CONNECT:
      event.type = NetEvent::Type::opened;
      prepare(got.peer);
      break;
    case ENET_EVENT_TYPE_DISCONNECT:
      event.type = NetEvent::Type::closed;
      break;
    default: {
      event.type = NetEvent::Type::received;
      const auto* const data = reinterpret_cast<const std::byte*>(got.packet->data);
      event.message.assign(data, data + got.packet->dataLength);
      enet_packet_destroy(got.packet);
    }
  }
  return true;
}

bool Enet::send(Link link, const OutgoingMessage& message) {
  ENetPacket* const packet = enet_packet_create(nullptr, message.size(), ENET_PACKET_FLAG_RELIABLE);
  if (packet == nullptr) return false;
  auto* out = reinterpret_cast<std::byte*>(packet->data);
  for (const auto piece : message.pieces()) out = std::copy(piece.begin(), piece.end(), out);
  host_->maximumPacketSize = kMaxSent;
  const bool queued = enet_peer_send(link, 0, packet) == 0;
  host_->maximumPacketSize = options_.max_received;
  if (!queued) enet_packet_destroy(packet);
  return queued;
}

/// enet_host_service() with an event reads the socket only when no event is left.
void Enet::attend() { enet_host_service(host_, nullptr, 0); }
void Enet::flush() { enet_host_flush(host_); }
void Enet::close(Link link) { enet_peer_disconnect_later(link, 0); }
void Enet::abandon(Link link) { enet_peer_disconnect_now(link, 0); }

std::uint16_t Enet::port() const {
  ENetAddress address{};
  return enet_socket_get_address(host_->socket, &address) == 0 ? address.port : 0;
}

int Enet::descriptor() const { return host_->socket; }

std::string Enet::host_of(Link link) {
  char name[64] = "?";
  static_cast<void>(enet_address_get_host_ip(&link->address, name, sizeof name));
  return name;
}

std::string Enet::address_of(Link link) {
  return fmt::format("{}:{}", host_of(link), link->address.port);
}

unsigned Enet::round_trip_ms(Link link) { return link->roundTripTime; }

void Enet::set_tag(Link link, std::uintptr_t tag) {
  link->data = reinterpret_cast<void*>(tag);  // NOLINT(performance-no-int-to-ptr)
}
std::uintptr_t Enet::tag(Link link) { return reinterpret_cast<std::uintptr_t>(link->data); }

}  // namespace gicodec::streaming
