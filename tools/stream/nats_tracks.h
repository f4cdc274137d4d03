// Tracks on NATS with JetStream: names of subjects and streams, and requests to servers
// (docs/streaming.md, "Many viewers").
#pragma once

#include "modules/nats.h"
#include "transport.h"

#include <gicodec/delivery.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::streaming {

/// The URLs, one by one. Throws tools::Error of Exit::usage, which names `flag`, for one that is no
/// URL of NATS, or has a password in it.
[[nodiscard]] std::vector<std::string> nats_urls(const std::string& urls, const char* flag);
/// Begins to connect. Throws tools::Error of Exit::usage or io.
[[nodiscard]] std::unique_ptr<tools::NatsConnection> open_nats(const NatsFlags& flags,
                                                               const char* program, double timeout);
/// True if the user of the connection lacks a right.
[[nodiscard]] bool is_refused(const tools::NatsState& state);
/// What a failure to connect means to the user, and the cure. Escaped.
[[nodiscard]] std::string nats_failure(const tools::NatsState& state);

/// A name as one token of a subject: bytes other than letters, digits, '-' and '_' become %XX.
[[nodiscard]] std::string subject_token(std::string_view name);

class TrackSubjects {
 public:
  /// Throws tools::Error of Exit::usage for a prefix that makes no subject.
  explicit TrackSubjects(const std::string& prefix);

  [[nodiscard]] const std::string& prefix() const noexcept { return prefix_; }
  /// Of a track's snapshots, number 0, or of its other objects of a number.
  [[nodiscard]] std::string object(const TrackName& track, std::uint32_t number) const;
  /// Of all of a track's objects that are no snapshots.
  [[nodiscard]] std::string updates(const TrackName& track) const {
    return object(track, 0) + ".*";
  }
  [[nodiscard]] std::string list() const { return prefix_ + ".list"; }
  [[nodiscard]] std::string tick() const { return prefix_ + ".tick"; }
  /// Its last message says which publisher there is.
  [[nodiscard]] std::string publisher() const { return prefix_ + ".publisher"; }

  /// The stream of the last message of each subject, and that of updates.
  [[nodiscard]] const std::string& kept_stream() const noexcept { return kept_; }
  [[nodiscard]] const std::string& update_stream() const noexcept { return updates_; }
  [[nodiscard]] std::vector<std::string> kept_subjects() const;
  [[nodiscard]] std::vector<std::string> update_subjects() const;

 private:
  std::string prefix_, kept_, updates_;
};

struct StreamSettings {
  std::uint32_t replicas = 1;
  double keep_seconds = 160;                            ///< of updates
  std::uint64_t keep_bytes = std::uint64_t{256} << 20;  ///< of updates
};

// Requests: `reply` is where the answer goes.

/// Creates a stream, or changes it to these settings.
[[nodiscard]] tools::NatsMessage make_kept_stream(const TrackSubjects& subjects,
                                                  const StreamSettings& settings, bool exists,
                                                  const std::string& reply);
[[nodiscard]] tools::NatsMessage make_update_stream(const TrackSubjects& subjects,
                                                    const StreamSettings& settings, bool exists,
                                                    const std::string& reply);
/// The last message of a subject, from any server that holds it, which may be behind.
[[nodiscard]] tools::NatsMessage get_last(const std::string& stream, const std::string& subject,
                                          const std::string& reply);

/// The number at the beginning of a text; 0: there is none.
[[nodiscard]] std::uint64_t number_in(std::string_view text);
/// A publisher's message that it has this epoch, and the epoch of one.
[[nodiscard]] tools::NatsMessage make_claim(const TrackSubjects& subjects, std::uint64_t epoch);
[[nodiscard]] std::uint64_t claimed_epoch(const tools::NatsMessage& message);

/// What JetStream answers to a message that it stores, or to make_…_stream().
struct StreamAnswer {
  std::string stream;
  std::uint64_t sequence = 0;
  int error = 0;          ///< JetStream's number; 0: it is stored or done
  std::string text = {};  ///< of the error; not escaped
};
inline constexpr int kErrorNoLeader = 10008;
inline constexpr int kErrorNoStream = 10059;
[[nodiscard]] StreamAnswer stream_answer(const tools::NatsMessage& message);
}  // namespace gicodec::streaming
