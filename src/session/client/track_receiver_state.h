// The state of a TrackReceiver. track_receiver.cpp takes what the publisher and the client send,
// track_updates.cpp makes updates of it.
#pragma once

#include <gicodec/track_receiver.h>

#include "session/client/track_table.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gicodec {

/// Ticks after which what is missing is requested again: so many, then twice as many each time.
inline constexpr std::uint32_t kFirstPatience = 2, kLastPatience = 16;
/// Ticks for which a client that begins waits until all that it wants has come.
inline constexpr std::uint32_t kFirstTicks = 10;

/// Rounds that may end between two updates to the client; of more, snapshots are requested.
inline constexpr std::uint32_t kMaxRounds = 32;
/// Objects that are requested after a tick, but for the last track's.
inline constexpr std::size_t kMaxRequests = 8192;

/// Memory that an object takes while it waits.
[[nodiscard]] inline std::size_t memory_of(const WaitingObject& waiting) noexcept {
  constexpr std::size_t kObject = 256;
  return waiting.bytes.size() + kObject;
}

/// Update and number of a stream's last object, by a tick; zeros: the tick does not name it.
struct LastObject {
  std::uint64_t update = 0;
  std::uint32_t number = 0;
};
[[nodiscard]] LastObject last_object(const TrackTick& tick, StreamId stream) noexcept;

/// An object to apply.
struct TrackStep {
  Track* track;
  const WaitingObject* waiting;
};

/// What takes a track forward.
struct TrackWay {
  std::uint64_t end = 0;  ///< update of the last step, or what is held
  bool by_snapshot = false;
};

struct TrackReceiver::State {
  Status take(TrackList list);
  Status take(WaitingObject waiting);
  Status take(TrackTick tick);
  template <typename Other>
  Status take(const Other& /*unused*/) {
    return Status::corrupt;
  }
  Status answer(const Hello& hello);
  Status answer(const Resync& resync);
  Status answer(const Subscribe& subscribe);
  Status answer(const Viewpoint& viewpoint);
  Status answer(const Acknowledge& acknowledge);
  Status answer(const Goodbye& /*unused*/);
  template <typename FromServer>
  Status answer(const FromServer& /*unused*/) {
    return Status::invalid_argument;
  }
  [[nodiscard]] int compare_run(std::uint64_t epoch, std::uint32_t generation) noexcept;
  void choose(TrackInterest next);
  void chose() noexcept;
  void request(const TrackUnit& unit, const Track& track,
               std::vector<TrackRequests::Object>& out) const;
  void count_waiting() noexcept;
  void forget_all_waiting() noexcept;
  [[nodiscard]] bool has_all(const TrackTick& as_of, const Track& track,
                             std::uint64_t end) const noexcept;
  void confirm(const TrackTick& as_of) noexcept;
  [[nodiscard]] TrackWay way_of(const Track& track) const noexcept;
  [[nodiscard]] static std::uint64_t reach_from(const Track& track, std::uint64_t from,
                                                std::uint64_t last) noexcept;
  [[nodiscard]] bool follow_presence(const TrackUnit& unit,
                                     std::vector<TrackWay>& ways) const noexcept;
  void add_steps(Track& track, const TrackWay& way, std::vector<TrackStep>& steps) const;
  Status welcome(std::vector<Message>& out);
  Status advance(std::vector<Message>& out);
  Status write(std::span<const TrackStep> steps, std::vector<Message>& out);

  TrackReceiverOptions options;
  TrackInterest interest;
  std::optional<TrackTable> table;
  std::optional<TrackTick> tick;  ///< the newest of the table's epoch and generation
  bool wants_list = true;
  std::uint32_t lists_missed = 0;  ///< ticks that named a later list
  bool has_news = false;           ///< something came since the last advance()
  bool new_tick = false;
  std::uint32_t rounds = 0;           ///< that ended since the last advance()
  std::optional<std::uint32_t> sync;  ///< of the client's last Hello or Resync
  std::uint32_t number = 0;           ///< of the last update to it
  bool welcomed = false;              ///< the client knows the table
  bool restarts = false;              ///< the client had a session of another table
  bool answered = false;              ///< the client has said what it wishes to see
  std::uint32_t ticks = 0;            ///< of the table
  std::uint32_t ticks_before = 0;     ///< those before the client's Hello
  bool begun = false;                 ///< the client has got an update since
  bool all = false;                   ///< see complete()
  std::uint64_t changes = 0;          ///< of the wanted tracks
  std::size_t waiting_bytes = 0;
  std::size_t requests_left = 0;
  TrackReceiverStatistics statistics;
};

}  // namespace gicodec
