// Statistics of a server: JSON lines while it runs, a table at the end, a CSV line per client and
// update.
#pragma once

#include "play_feed.h"

#include <gicodec/server.h>
#include <gicodec/track_publisher.h>

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::streaming {

/// Mean and largest of some durations.
struct Durations {
  double sum = 0, most = 0;
  std::uint64_t count = 0;
  void add(double seconds);
  [[nodiscard]] double mean_ms() const;
};

class ServerStatistics {
 public:
  struct Output {
    bool json = false;   ///< lines to standard output, else a table at the end
    std::string file;    ///< lines to this file as well
    std::string log;     ///< CSV of updates
    bool quiet = false;  ///< no table, no status line
  };
  ServerStatistics(const Output& output, const std::vector<FeedVolume>& volumes);
  ~ServerStatistics();
  ServerStatistics(const ServerStatistics&) = delete;
  ServerStatistics& operator=(const ServerStatistics&) = delete;

  void opened(ConnectionId connection, const std::string& address);
  void named(ConnectionId connection, const std::string& user);
  void closed(Server& server, ConnectionId connection);

  struct Update {
    std::uint64_t number = 0;
    double time = 0;            ///< of the scene
    double trace_seconds = -1;  ///< negative: there is no new frame
    double encode_seconds = 0;
    std::size_t active = 0;  ///< blocks of the first volume
    double now = 0;
  };
  /// Call this after each update, before taking its messages.
  void updated(Server& server, const Update& update);
  void viewed(double seconds) { views_.add(seconds), all_views_.add(seconds); }
  void late() { ++late_; }
  /// What has gone to NATS so far, and how many messages the servers have not stored yet.
  void published(const TrackStatistics& tracks, std::uint64_t unanswered) {
    published_ = tracks;
    unanswered_ = unanswered;
  }
  struct Totals {
    std::uint64_t late = 0, bytes = 0, blocks = 0;
    Durations encode, latency;
    std::vector<float> latencies;                   ///< most recent ones, seconds
    std::optional<TrackStatistics> published = {};  ///< over NATS
    std::uint64_t unanswered = 0;
  };
  [[nodiscard]] Totals totals(Server& server);
  /// Writes a line if a second has passed since the last one.
  void tick(Server& server, double now);
  /// Writes the last lines and the table.
  void finish(Server& server, double now);
  /// A sentence on the first file that could not be written completely; once, then empty.
  [[nodiscard]] std::string trouble();
  /// Throws tools::Error of Exit::io if a file could not be written completely.
  void check_written() const;

 private:
  struct Connection {
    std::string address, user;
    ConnectionStatistics last;     ///< as of the last line
    std::vector<float> latencies;  ///< since the last line
  };
  void collect(Server& server, ConnectionId id, Connection& connection);
  nlohmann::ordered_json line(Server& server, double now);
  [[nodiscard]] bool wants_lines() const { return lines_ != nullptr || output_.json; }
  void write(const nlohmann::ordered_json& json);
  void status(const nlohmann::ordered_json& line) const;
  [[nodiscard]] double updating_seconds() const;
  void table(Server& server) const;
  [[nodiscard]] nlohmann::ordered_json published_json() const;

  Output output_;
  std::vector<std::string> streams_;       ///< columns of the log: the volumes' textures
  std::vector<std::size_t> first_stream_;  ///< of each volume
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> lines_, log_;
  std::map<ConnectionId, Connection> connections_;
  Durations trace_, encode_, views_, all_trace_, all_encode_, all_views_;
  std::vector<float> all_latencies_;
  std::vector<float> recent_;  ///< latencies, the oldest replaced by the newest
  Durations latency_;
  std::optional<TrackStatistics> published_;
  std::uint64_t unanswered_ = 0;
  std::uint64_t updates_ = 0, late_ = 0, bytes_ = 0, blocks_ = 0, last_updates_ = 0;
  std::size_t most_connections_ = 0;
  double began_ = -1, last_ = 0;
  double first_update_ = 0, last_update_ = 0;
  bool terminal_ = false, troubled_ = false;
};

}  // namespace gicodec::streaming
