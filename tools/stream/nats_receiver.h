// Tracks over NATS as a link: what a client sends goes to a TrackReceiver, what that makes of the
// publisher's messages comes back as those of a server.
#pragma once

#include "nats_tracks.h"
#include "transport.h"

#include <gicodec/track_receiver.h>

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gicodec::streaming {

/// One thread; throws tools::Error.
class NatsReceiver {
 public:
  NatsReceiver(const NatsFlags& flags, const TrackReceiverOptions& options, double timeout);

  /// The next event, waiting for at most so long: `opened`, `received`, `renewed` or `closed`.
  [[nodiscard]] bool next(NetEvent& event, unsigned milliseconds);
  /// Takes a message of the client; after a Goodbye the link closes.
  void send(std::span<const std::byte> message);
  /// `closed` follows.
  void close();
  void set_tag(std::uintptr_t tag) noexcept { tag_ = tag; }
  [[nodiscard]] std::uintptr_t tag() const noexcept { return tag_; }
  [[nodiscard]] const TrackReceiverStatistics& statistics() const noexcept {
    return tracks_.statistics();
  }

 private:
  void watch_connection();
  void watch_publisher();
  void handle(const tools::NatsMessage& message);
  void follow_wanted();
  void fetch();
  void push(NetEvent::Type type, Message message = {});

  TrackSubjects subjects_;
  TrackReceiver tracks_;
  std::unique_ptr<tools::NatsConnection> connection_;
  double timeout_, lost_ = 0;  ///< seconds; when the connection was lost, 0: it is there
  bool opened_ = false, closed_ = false;
  double heard_ = 0;     ///< when the last tick came
  bool silent_ = false;  ///< that none comes was said
  std::uint64_t ticks_ = 0, earlier_ = 0;
  std::uint64_t wanted_changes_ = 0, requests_ = 0;
  std::map<StreamId, std::uint64_t> subscriptions_;  ///< of updates
  std::deque<NetEvent> events_;
  std::uintptr_t tag_ = 0;
};

}  // namespace gicodec::streaming
