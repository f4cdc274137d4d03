// Publishes tracks over NATS, and takes over from a publisher that is gone.
#pragma once

#include "nats_tracks.h"
#include "nats_unanswered.h"

#include <gicodec/track_publisher.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

namespace gicodec::streaming {

struct NatsPublisherOptions {
  NatsFlags nats;
  StreamSettings streams;
  double timeout = 2;        ///< seconds for one attempt to connect
  double patience = 15;      ///< seconds in which the servers must answer at first
  double standby_after = 1;  ///< seconds without an update after which a standby takes over
};

/// What to do where the servers keep no more.
inline constexpr const char* kFullCure =
    "max_memory_store in the servers' configuration gives it more room, --nats-max-mb asks for "
    "less";

/// The epoch of this publisher, and where it goes on. An epoch is above the last one, and at least
/// the time in seconds, so that it grows also where the servers have forgotten the last one.
struct Turn {
  std::uint64_t epoch = 0;
  std::optional<double> time;  ///< the scene's time in the last update of the one before
};

/// One thread. Throws tools::Error where it cannot begin; later faults are remarks().
class NatsPublisher {
 public:
  explicit NatsPublisher(const NatsPublisherOptions& options);

  /// Becomes the publisher at once; the one before ends.
  [[nodiscard]] Turn begin();
  /// Waits until no publisher is there any more, and takes its place. `follow` is called with the
  /// time of each update of the other, nullopt at first. nullopt: the program was interrupted.
  [[nodiscard]] std::optional<Turn> stand_by(
      const std::function<void(std::optional<double>)>& follow);

  /// Publishes the messages of an update.
  void publish(TrackPublisher& tracks);
  /// Takes answers of the servers, and repeats what they did not store. Call it often. False: there
  /// is a later publisher, and this one must end.
  [[nodiscard]] bool attend(TrackPublisher& tracks);
  /// What the operator should know since the last call; empty: nothing.
  [[nodiscard]] std::string remarks();
  [[nodiscard]] std::uint64_t unanswered() const noexcept { return unanswered_.size(); }
  /// Bytes of a message, at most.
  [[nodiscard]] std::size_t max_payload() { return connection_->state().max_payload; }

 private:
  [[nodiscard]] tools::NatsMessage ask(const tools::NatsMessage& request, const char* what);
  [[nodiscard]] std::optional<tools::NatsMessage> answer_to(const tools::NatsMessage& request,
                                                            double seconds);
  void check_rights(const char* what);
  void wait_for_servers();
  void make_streams();
  [[nodiscard]] std::optional<Turn> claim(bool wait);
  void handle(const tools::NatsMessage& message, TrackPublisher& tracks);
  void ask_to_resume(std::uint64_t connections);
  void resume(const tools::NatsMessage& last, TrackPublisher& tracks);
  void answered(const tools::NatsMessage& message, TrackPublisher& tracks);
  void publish_streams();
  void repeat(TrackPublisher& tracks);
  enum class Fault : std::uint8_t { not_reached, not_stored, too_large, slow };
  void remark(const std::string& text);
  void remark(Fault fault, const std::string& text);

  NatsPublisherOptions options_;
  TrackSubjects subjects_;
  std::unique_ptr<tools::NatsConnection> connection_;
  std::uint64_t answers_ = 0, claims_ = 0, ticks_ = 0;  ///< subscriptions
  std::uint64_t requests_ = 0;                          ///< made so far
  std::uint64_t epoch_ = 0, connections_ = 0;
  std::uint64_t heard_epoch_ = 0;                               ///< while standing by
  std::uint64_t resume_request_ = 0, resumed_connections_ = 0;  ///< asked after a loss
  double asked_ = 0;
  UnansweredMessages unanswered_;
  double gave_up_ = 0;  ///< when messages were last given up
  bool replaced_ = false;
  std::set<Fault> faults_;  ///< that were said and are not over
  std::string remarks_;
};

}  // namespace gicodec::streaming
