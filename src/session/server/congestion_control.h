// How much a client is sent: as much as it acknowledges without updates queueing on their way to
// it. The signal is the time to an acknowledgement beyond that of an idle path, whatever the queue
// is: a slow link, a busy machine, a decoder that does not keep up.
#pragma once

#include <gicodec/delivery.h>

#include <cstdint>
#include <optional>

namespace gicodec {

/// How many blocks the next update may have in packets for few, if the last one took so many
/// seconds for what it wrote and one may take `most`. `before`: the limit so far; 0, here and
/// there: none.
[[nodiscard]] double next_unicast_block_limit(double before, const WrittenBlocks& written,
                                              double seconds, double most) noexcept;

class CongestionControl {
 public:
  /// `first`: bytes of the first update.
  explicit CongestionControl(std::uint64_t first) noexcept;

  /// Of an update that was acknowledged, or is about to be made.
  struct Sent {
    double made = 0;          ///< seconds; when it was handed to the transport, if that is known
    std::uint64_t bytes = 0;  ///< its own
    std::uint64_t delivered = 0;  ///< of earlier ones that were acknowledged by then
    bool limited = false;         ///< more would have been sent but for the budget
    bool alone = false;           ///< nothing else was on its way
    bool empty = false;           ///< nothing was in it, on purpose
  };

  /// A small message was answered after so many seconds.
  void answered(double seconds, double now) noexcept;
  /// Bytes that an update may have now; 0: only an empty one, which tells how long the idle path
  /// takes; nothing: none may be made yet. `oldest`: when the oldest update on its way was made, if
  /// there is one; `interval`: seconds between updates.
  [[nodiscard]] std::optional<std::uint64_t> budget(double now, std::optional<double> oldest,
                                                    std::uint64_t bytes_in_flight,
                                                    double interval) noexcept;
  [[nodiscard]] std::uint64_t delivered() const noexcept { return delivered_; }
  /// An update was acknowledged. `mean`: what all congestion controls allow on average; those above
  /// it shrink more and grow less, so that shares become even.
  void acknowledged(const Sent& update, double now, double interval, double mean) noexcept;
  [[nodiscard]] double bytes() const noexcept { return bytes_; }  ///< of an update, in the long run

 private:
  double first_, bytes_;     ///< the budget at first, and now
  double idle_ = -1;         ///< seconds to an acknowledgement on an idle path; -1: not known
  double idle_at_ = 0;       ///< when that was seen
  double changed_ = -1e300;  ///< when the budget was; what was made before tells nothing of it
  std::uint64_t delivered_ = 0;
  bool limited_ = false;  ///< as of the last acknowledgement
  bool starting_ = true;  ///< until the first sign of a queue
  bool looking_ = false;  ///< nothing is made until the path was seen idle
};

}  // namespace gicodec
