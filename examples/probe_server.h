// What a renderer does to stream its probes, whatever carries the messages.
#pragma once

#include <gicodec/streaming.h>

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

/// The engine's: sockets, or whatever it numbers its connections by.
struct ServerTransport {
  /// Reliable and in order; what is to be sent as one message is in pieces().
  std::function<void(int socket, const gicodec::OutgoingMessage&)> send;
  std::function<void(int socket)> close;  ///< once all is sent
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
    // For tokens of users set .access.authorise instead, called with the token of each Hello.
    auto server = Server::create({.threads = 4, .scene = scene, .access = {.token = token}});
    if (!server) return server.status();
    const NamedTexture textures[] = {{"color", ddgi_irradiance(geometry.grid)},
                                     {"vis", ddgi_visibility(geometry.grid)}};
    const auto probes = probe_volume(textures);
    if (!probes) return probes.status();
    const StreamedTexture rates[] = {{.texture = "vis", .interval = 2}};
    const auto volume = server->add_volume("world", *probes, geometry, rates);
    if (!volume) return volume.status();
    return ProbeServer(*std::move(server), *volume, std::move(transport));
  }

  // Whenever the transport has something. Times are seconds of any clock that does not go back.
  void connected(int socket, double now) {
    const auto connection = server_.connect(now);
    if (connection) {
      connections_[socket] = *connection;
    } else {
      transport_.close(socket);  // There are too many, or there is no memory.
    }
  }
  void received(int socket, const gicodec::Message& message, double now) {
    // Never fails: connections that break rules are dropped.
    const auto connection = connections_.find(socket);
    if (connection != connections_.end()) server_.receive(connection->second, message, now);
  }
  void lost(int socket, double now) {
    const auto connection = connections_.find(socket);
    if (connection == connections_.end()) return;
    server_.disconnect(connection->second, now);  // Its session is kept for a while.
    connections_.erase(connection);
  }

  /// One update, 10 to 30 times a second. `positions_seen` gives what a viewpoint sees.
  template <typename PositionsSeen>
  gicodec::Status update(const ProbeTextures& textures, const PositionsSeen& positions_seen,
                         double now, double interval) {
    using namespace gicodec;
    const auto begin = std::chrono::steady_clock::now();
    // An error is one of the arguments', or out_of_memory; what is not published stays as it was.
    Status status = server_.publish(volume_, 0, textures.color);
    if (status == Status::ok) status = server_.publish(volume_, 1, textures.visibility);
    if (status == Status::ok) status = server_.set_active(volume_, textures.active);
    for (const auto& [socket, connection] : connections_) {
      const auto view = server_.viewpoint(connection);  // A client without one is sent everything.
      if (!view || status != Status::ok) continue;
      BlockMask mask(textures.active.size());
      add_shading_probes(*server_.geometry(volume_), positions_seen(*view), mask);
      status = server_.set_visible(connection, volume_, mask);
    }
    // Go on after an error: clients that got nothing this time get it with a later update.
    const Status made = server_.update(now, textures.time);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    // If time is short: fewer packets for single clients, faster presets.
    server_.report_update_time(taken.count(), interval);
    deliver(now);
    return status == Status::ok ? made : status;
  }

 private:
  ProbeServer(gicodec::Server&& server, std::uint16_t volume, ServerTransport transport)
      : server_(std::move(server)), volume_(volume), transport_(std::move(transport)) {}

  void deliver(double now) {
    for (const auto& [socket, connection] : connections_) {
      for (const auto& message : server_.take_messages(connection))
        transport_.send(socket, message);
    }
    // Clients that joined or left, and why.
    for (const gicodec::ServerEvent& event : server_.take_events()) {
      if (event.type != gicodec::ServerEvent::Type::dropped) continue;
      for (const auto& [socket, connection] : connections_) {
        if (connection != event.connection) continue;
        transport_.close(socket);
        lost(socket, now);
        break;
      }
    }
  }

  gicodec::Server server_;
  std::uint16_t volume_;
  ServerTransport transport_;
  std::map<int, gicodec::ConnectionId> connections_;
};
