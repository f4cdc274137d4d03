// Receiver of tracks, see track_publisher.h: stands between the messages of a publisher and a
// Client of shared delivery. It knows no transport.
#pragma once

#include <gicodec/api.h>
#include <gicodec/delivery.h>
#include <gicodec/kind.h>
#include <gicodec/protocol.h>
#include <gicodec/status.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace GICODEC_API gicodec {

struct TrackReceiverOptions {
  std::vector<const Kind*> kinds = {};  ///< besides the built-in ones; outlive the receiver
  /// Distance from the viewpoint, in world units, up to which regions of grids are received, the
  /// nearest first. 0: all of them, or those of the client's Subscribe.
  float reach = 0;
  bool subscribed_only = false;        ///< nothing but the regions of the client's Subscribe
  std::uint32_t max_tracks = 1 << 17;  ///< of a list
  /// Bytes of objects that wait for others. Beyond them the receiver asks for snapshots.
  std::size_t max_waiting_bytes = std::size_t{256} << 20;
};

/// What the transport should fetch. Answers go to TrackReceiver::receive(), in any order.
struct TrackRequests {
  struct Object {
    StreamId stream;
    std::uint32_t number;
  };
  bool list = false;                 ///< the last list, and the last tick
  std::vector<Object> objects = {};  ///< those of the nearest tracks first
};

struct TrackReceiverStatistics {
  std::uint64_t ticks = 0;     ///< each later than the one before
  std::uint64_t objects = 0;   ///< of wanted tracks, received for the first time
  std::uint64_t repeated = 0;  ///< received again
  std::uint64_t earlier = 0;   ///< of an earlier epoch or generation, and ignored
  std::uint64_t damaged = 0;   ///< messages that could not be read
  std::uint64_t requests = 0;  ///< of objects
};

/// Stands between messages of tracks and a Client of shared delivery, for which it is the server.
/// One thread at a time. Safe on hostile messages.
class TrackReceiver {
 public:
  /// invalid_argument (options).
  [[nodiscard]] static Result<TrackReceiver> create(const TrackReceiverOptions& options = {});
  TrackReceiver(TrackReceiver&&) noexcept;
  TrackReceiver& operator=(TrackReceiver&&) noexcept;
  ~TrackReceiver();

  /// Takes a message of the publisher. Missing, repeated, reordered and damaged ones are no errors.
  /// out_of_memory, and for a list: unknown_kind, limit_exceeded, corrupt; it is then ignored.
  Status receive(std::span<const std::byte> message);
  /// Takes a message of the client, see Client::hello() and Client::take_messages(). What a server
  /// would drop a client for is invalid_argument.
  Status take(std::span<const std::byte> message);
  /// Moves out the messages for the client. Call it when no more can be received without waiting:
  /// all updates that have come make one message. out_of_memory: call it again.
  [[nodiscard]] Result<std::vector<Message>> take_messages();

  /// The tracks to receive updates of, the nearest first; receive lists and ticks always.
  [[nodiscard]] std::span<const StreamId> wanted() const noexcept;
  [[nodiscard]] std::uint64_t wanted_changes() const noexcept;  ///< counts changes of wanted()
  /// True if there is a publisher of a later epoch, and what is wanted of it has come: the client's
  /// next Hello begins with it. Until then the client keeps the last state.
  [[nodiscard]] bool wants_hello() const noexcept;
  /// Moves out what to fetch. Subscribe to wanted() before.
  [[nodiscard]] Result<TrackRequests> take_requests();
  /// True if the client has all wanted tracks as of the last tick.
  [[nodiscard]] bool complete() const noexcept;
  /// nullopt for a stream that does not exist. Valid until receive().
  [[nodiscard]] std::optional<TrackName> name(StreamId stream) const noexcept;
  [[nodiscard]] const TrackReceiverStatistics& statistics() const noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit TrackReceiver(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
