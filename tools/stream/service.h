// A running server: connections, updates at their rate, culling, statistics, shutdown.
#pragma once

#include "access.h"
#include "background.h"
#include "control.h"
#include "log.h"
#include "nats_publisher.h"
#include "net.h"
#include "play_feed.h"
#include "server_statistics.h"
#include "views.h"

#include <gicodec/server.h>
#include <gicodec/track_publisher.h>

#include <fmt/core.h>

#include <map>
#include <memory>
#include <optional>
#include <string>

namespace gicodec::streaming {

struct ServiceOptions {
  std::optional<Address> listen;  ///< for ENet
  std::optional<WebListen> web;   ///< for WebSockets
  NetOptions net;
  std::string port_file;
  std::string control;        ///< path of the operator's socket; empty: none
  double rate = 10;           ///< updates per second
  double start = 0;           ///< the scene's time at the first update
  std::uint64_t updates = 0;  ///< to make; 0: until interrupted
  std::uint32_t wait = 0;     ///< clients to wait for before the first update
  bool lockstep = false;      ///< each update has the next frame and waits for it
  bool quiet = false;
  TrackOptions tracks;  ///< with a NatsPublisher
  ServerStatistics::Output statistics;
};

class Service {
 public:
  /// Adds the feed's volumes to the server. `access`: that of the server. Without `views` clients
  /// see everything, unless they subscribe. `nats`: publishes, too; null: nothing does.
  Service(const ServiceOptions& options, Server server, std::shared_ptr<Access> access,
          const Feed& feed, std::unique_ptr<Views> views,
          const std::vector<std::vector<StreamedTexture>>& textures,
          std::unique_ptr<NatsPublisher> nats);

  /// Returns once all updates are made and acknowledged, or after an interrupt.
  void run();

 private:
  struct Connection {
    Link link;
    std::string address, user;
    bool chooses = false;  ///< the client has subscribed
    bool closing = false;
  };
  /// When a session began, and what its lost connections carried.
  struct Session {
    double began = 0;
    std::uint64_t bytes = 0, updates = 0;
  };

  void begin();
  void serve();
  void handle(NetEvent& event);
  void open(Link link);
  void take_events();
  void take(const ServerEvent& event);
  [[nodiscard]] std::string account(ConnectionId id, bool ends);
  void serve_control();
  [[nodiscard]] std::string answer(const std::string& command);
  [[nodiscard]] std::string list();
  [[nodiscard]] std::string drop(const std::string& client);
  [[nodiscard]] std::string reload();
  void show();
  std::size_t send(ConnectionId id);
  void send_all();
  void publish(const FeedFrame& frame);
  void tell_pace();
  void take_background();
  void request_frame();
  void request_views();
  void update();
  void begin_tracks();
  void publish_tracks();
  void attend_tracks();
  [[nodiscard]] Status update_and_listen();
  void show_nothing(ConnectionId id);
  void set_visible(ConnectionId id, std::uint16_t volume, std::span<const std::uint8_t> blocks,
                   std::uint8_t group);
  [[nodiscard]] bool may_update();
  [[nodiscard]] bool all_taken();
  void say_goodbye();
  template <typename... Args>
  void log(fmt::format_string<Args...> format, Args&&... args) {
    log_text(fmt::format(format, std::forward<Args>(args)...));
  }
  void log_text(const std::string& text);

  ServiceOptions options_;
  Server server_;
  std::shared_ptr<Access> access_;
  std::vector<FeedVolume> volumes_;
  std::vector<std::string> remarks_;  ///< of the feed
  bool played_ = false;
  std::unique_ptr<Views> views_;
  std::vector<ViewedVolume> viewed_;  ///< of every volume
  Net net_;
  std::optional<Control>
      control_;  // Before statistics_, which empties its files: the socket may fail.
  ServerStatistics statistics_;
  std::map<ConnectionId, Connection> connections_;
  std::map<ClientId, Session> sessions_;
  std::map<Reason, std::uint64_t> dropped_;
  double shown_ = 0;  ///< when the metrics were last shown
  LogLimit log_limit_;

  std::uint64_t made_ = 0;       ///< updates
  std::uint64_t requested_ = 0;  ///< frames
  bool fresh_ = false;           ///< a frame was published since the last update
  double time_ = 0;              ///< of the scene, as published
  double trace_seconds_ = -1;
  unsigned slow_frames_ = 0;  ///< consecutive ones that took longer than an update
  std::size_t active_ = 0;

  std::unique_ptr<NatsPublisher> nats_;
  std::optional<TrackPublisher> tracks_;  ///< of server_, if nats_ is there
  bool replaced_ = false;                 ///< another publisher has taken over

  Background<FeedRequest, FeedFrame> tracer_;
  Background<double, Status> updater_;  ///< uses the server while it works
  std::optional<Background<ViewRequest, ViewResult>> viewer_;
};

}  // namespace gicodec::streaming
