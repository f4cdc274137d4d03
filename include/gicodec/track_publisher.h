// Publisher of tracks: shared streams for any number of receivers that it does not know, over what
// carries messages by subject and keeps some of them, such as a message broker. A track is a region
// of a texture; a snapshot begins a group of its objects, and updates follow (docs/protocol.md,
// "Tracks"). It knows no transport.
#pragma once

#include <gicodec/api.h>
#include <gicodec/delivery.h>
#include <gicodec/protocol.h>
#include <gicodec/server.h>
#include <gicodec/status.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace GICODEC_API gicodec {

/// A message to publish. The transport keeps the last list and the last tick, and of each track the
/// last object of each number: snapshots until the next, others for kept_seconds().
struct TrackMessage {
  enum class Type : std::uint8_t { list, object, tick };
  Type type{};
  StreamId stream = {};      ///< of objects
  std::uint32_t number = 0;  ///< TrackObject::number
  Message bytes = {};
};

struct TrackOptions {
  static constexpr double kLongest = 8;  ///< intervals, while snapshots would exceed their share
  /// A track that changed gets its next snapshot within so many seconds, or kLongest times as many.
  double snapshot_seconds = 10;
  double snapshot_share = 0.25;  ///< of snapshots in all bytes, over 0 and below 1
};

/// Seconds for which a transport should keep updates: two of the longest intervals.
[[nodiscard]] constexpr double kept_seconds(const TrackOptions& options) noexcept {
  return 2 * TrackOptions::kLongest * options.snapshot_seconds;
}

struct TrackStatistics {
  std::uint64_t updates = 0, update_bytes = 0;  ///< objects published
  std::uint64_t snapshots = 0, snapshot_bytes = 0;
  std::uint64_t other_bytes = 0;  ///< of lists and ticks
};

/// Publishes what a Server serves. One thread at a time, that of the server.
class TrackPublisher {
 public:
  /// `server` must outlive the publisher, and not be moved. Its epoch must be above that of every
  /// publisher before it, so not drawn: receivers ignore lower ones. Errors: invalid_argument
  /// (options); limit_exceeded (ServerLimits::max_clients, of which a publisher takes two);
  /// out_of_memory.
  [[nodiscard]] static Result<TrackPublisher> create(Server& server,
                                                     const TrackOptions& options = {});
  TrackPublisher(TrackPublisher&&) noexcept;
  TrackPublisher& operator=(TrackPublisher&&) noexcept;
  ~TrackPublisher();

  /// Server::update(), and the messages of that update. The errors are those of Server::update():
  /// after out_of_memory some messages are missing, and the next update makes up for them.
  Status update(double now, double time);
  /// Of the last update, in the order in which to publish them.
  [[nodiscard]] std::span<const TrackMessage> messages() const noexcept;
  /// nullopt for a stream that does not exist. Valid until volumes are added or removed.
  [[nodiscard]] std::optional<TrackName> name(StreamId stream) const noexcept;
  /// Makes snapshots of all tracks with the next update: the transport may have lost messages.
  void repeat_snapshots() noexcept;
  [[nodiscard]] const TrackStatistics& statistics() const noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit TrackPublisher(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
