// What a renderer does to stream its probes, whatever carries the messages.
#pragma once

#include <gicodec/streaming.h>

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

/// The engine's: connections have numbers of its own.
struct ServerTransport {
  /// Reliable and in order; what is to be sent as one message is in pieces().
  std::function<void(int connection, const gicodec::OutgoingMessage&)> send;
  std::function<void(int connection)> close;  ///< once all is sent
};

/// The engine's: what was rendered for one update.
struct ProbeTextures {
  gicodec::ConstTextureView color, visibility;  ///< of mapped memory; read during the call
  std::vector<std::uint8_t> active;             ///< 0: inside a wall, never sent
  double time = 0;                              ///< of the scene, seconds
};

class ProbeServer {
 public:
  static gicodec::Result<ProbeServer> create(const gicodec::VolumeGeometry& geometry,
                                             const gicodec::SceneId& scene,
                                             const std::string& token, ServerTransport transport) {
    using namespace gicodec;
    // For tokens of users set .authorise instead: it is called with the token of each Hello.
    auto host = Host::create({.threads = 4, .token = token, .scene = scene});
    if (!host) return host.status();
    const NamedTexture textures[] = {{"color", ddgi_irradiance(geometry.grid)},
                                     {"vis", ddgi_visibility(geometry.grid)}};
    const auto probes = probe_volume(textures);
    if (!probes) return probes.status();
    const StreamedTexture rates[] = {{.texture = "vis", .interval = 2}};
    const auto volume = host->add_volume("world", *probes, geometry, rates);
    if (!volume) return volume.status();
    return ProbeServer(*std::move(host), *volume, std::move(transport));
  }

  // Whenever the transport has something. Times are seconds of any clock that does not go back.
  void connected(int connection, double now) {
    const auto peer = host_.connect(now);
    if (peer) {
      peers_[connection] = *peer;
    } else {
      transport_.close(connection);  // There are too many, or there is no memory.
    }
  }
  void received(int connection, const gicodec::Message& message, double now) {
    const auto peer = peers_.find(connection);  // Never fails: peers that break rules are dropped.
    if (peer != peers_.end()) host_.receive(peer->second, message, now);
  }
  void lost(int connection, double now) {
    const auto peer = peers_.find(connection);
    if (peer == peers_.end()) return;
    host_.disconnect(peer->second, now);  // Its session is kept for a while.
    peers_.erase(peer);
  }

  /// One update, 10 to 30 times a second. `positions_seen` gives what a viewpoint sees.
  template <typename PositionsSeen>
  gicodec::Status update(const ProbeTextures& textures, const PositionsSeen& positions_seen,
                         double now, double interval) {
    using namespace gicodec;
    const auto begin = std::chrono::steady_clock::now();
    // An error is one of the arguments', or out_of_memory; what is not published stays as it was.
    Status status = host_.publish(volume_, 0, textures.color);
    if (status == Status::ok) status = host_.publish(volume_, 1, textures.visibility);
    if (status == Status::ok) status = host_.set_active(volume_, textures.active);
    for (const auto& [connection, peer] : peers_) {
      const auto view = host_.viewpoint(peer);  // A client without one is sent everything.
      if (!view || status != Status::ok) continue;
      BlockMask mask(textures.active.size());
      add_shading_probes(*host_.geometry(volume_), positions_seen(*view), mask);
      status = host_.set_visible(peer, volume_, mask);
    }
    // Go on after an error: clients that got nothing this time get it with a later update.
    const Status made = host_.update(now, textures.time);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    host_.took(taken.count(), interval);  // Limits packets for single clients if time is short.
    deliver(now);
    return status == Status::ok ? made : status;
  }

 private:
  ProbeServer(gicodec::Host&& host, std::uint16_t volume, ServerTransport transport)
      : host_(std::move(host)), volume_(volume), transport_(std::move(transport)) {}

  void deliver(double now) {
    for (const auto& [connection, peer] : peers_) {
      for (const auto& message : host_.take_messages(peer)) transport_.send(connection, message);
    }
    for (const gicodec::HostEvent& event :
         host_.take_events()) {  // Clients that joined or left, and why.
      if (event.kind != gicodec::HostEvent::Kind::dropped) continue;
      for (const auto& [connection, peer] : peers_) {
        if (peer != event.peer) continue;
        transport_.close(connection);
        lost(connection, now);
        break;
      }
    }
  }

  gicodec::Host host_;
  std::uint16_t volume_;
  ServerTransport transport_;
  std::map<int, gicodec::PeerId> peers_;
};
