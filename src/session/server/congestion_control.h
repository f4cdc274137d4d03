// Congestion control: sends a client as much as it acknowledges without updates queueing. It
// measures the delay of acknowledgements beyond that of an idle path, whatever causes the queue: a
// slow link, a busy machine, a slow decoder.
#pragma once

#include <gicodec/delivery.h>

#include <cstdint>
#include <optional>

namespace gicodec {

/// The next limit of blocks in packets for few clients, see Server::set_limit_for_few().
/// `seconds`: how long the last update took; `most`: how long one may take; `before`: the present
/// limit. A limit of 0 is none.
[[nodiscard]] double next_limit_for_few(double before, const WrittenBlocks& written, double seconds,
                                        double most) noexcept;

class CongestionControl {
 public:
  /// `first`: bytes of the first update.
  explicit CongestionControl(std::uint64_t first) noexcept;

  /// An update.
  struct Sent {
    double made = 0;              ///< seconds; when the transport got it, if that is known
    std::uint64_t bytes = 0;      ///< its size
    std::uint64_t delivered = 0;  ///< bytes of earlier updates acknowledged when it was made
    bool limited = false;         ///< the budget kept more blocks out of it
    bool alone = false;           ///< nothing else was in flight
    bool empty = false;           ///< made empty, to measure the idle path
  };

  /// A small message was answered after so many seconds.
  void answered(double seconds, double now) noexcept;
  /// Bytes that an update may have at `now`. 0: make an empty one, which measures the idle path;
  /// nullopt: make none yet. `oldest`: when the oldest update in flight was made, if there is one;
  /// `interval`: seconds between updates.
  [[nodiscard]] std::optional<std::uint64_t> budget(double now, std::optional<double> oldest,
                                                    std::uint64_t bytes_in_flight,
                                                    double interval) noexcept;
  [[nodiscard]] std::uint64_t delivered() const noexcept { return delivered_; }
  /// An update was acknowledged. `mean`: mean of bytes() over all clients. Budgets above it shrink
  /// more and grow less, so that shares become even.
  void acknowledged(const Sent& update, double now, double interval, double mean) noexcept;
  [[nodiscard]] double bytes() const noexcept { return bytes_; }  ///< budget of an update
  /// Bytes per second of recent updates while they were on their way, from the time at which an
  /// empty one would have been acknowledged. 0: not known; infinity: they took no such time.
  [[nodiscard]] double throughput() const noexcept;

 private:
  double first_, bytes_;     ///< the first budget, and the present one
  double idle_ = -1;         ///< seconds to an acknowledgement on an idle path; -1: unknown
  double idle_at_ = 0;       ///< when idle_ was measured
  double changed_ = -1e300;  ///< when the budget changed; earlier updates say nothing about it
  std::uint64_t delivered_ = 0;
  double acknowledged_ = -1e300;           ///< when the last update was
  double update_bytes_ = 0, seconds_ = 0;  ///< recent means of updates, for throughput()
  bool limited_ = false;                   ///< Sent::limited of the last update acknowledged
  bool starting_ = true;                   ///< until the first sign of a queue
  bool looking_ = false;                   ///< no update until the idle path is measured
};

}  // namespace gicodec
