// How often a client of shared streams takes part in them: in every update, in every second,
// fourth,
// ... one, so that it gets no more than its budget on average. Where there are few streams, clients
// are in up to four groups that take turns. Those of a group and a rate take part in the same
// updates, those of a slower rate only where those of a faster one do: packets made for one serve
// all.
#pragma once

#include <gicodec/delivery.h>

#include <cstddef>
#include <cstdint>

namespace gicodec {

class SharedRate {
 public:
  explicit SharedRate(std::uint32_t group) noexcept : group_(group) {}

  /// Before an update: for a client of so many streams, blocks of which have some bytes.
  void choose(const Budget& budget, std::size_t streams, std::size_t bytes_of_a_stream) noexcept;
  /// True if the client takes part in a stream in this update. `place` numbers the streams.
  [[nodiscard]] bool turn(std::uint64_t update, std::size_t place) const noexcept;
  /// It does so in every 2^tier-th update.
  [[nodiscard]] unsigned tier(std::size_t place) const noexcept;
  /// True if it does not take part in everything.
  [[nodiscard]] bool slowed() const noexcept { return tier_ > 0 || faster_ < 1; }
  /// Of all packets, the share that it gets.
  [[nodiscard]] float share() const noexcept { return share_; }
  /// After an update: what came of the streams whose turn it was.
  void sent(std::size_t turns, std::size_t bytes, std::size_t blocks) noexcept;

 private:
  static constexpr unsigned kSlowest = 5;  ///< every 32nd update

  std::uint32_t group_, groups_ = 1;
  float bytes_ = 0, blocks_ = 0;  ///< in a turn, of late
  bool measured_ = false;
  std::size_t streams_ = 0;
  unsigned tier_ = 0;  ///< every 2^tier-th update for some streams, half of that for the others
  float faster_ = 1, share_ = 1;
};

}  // namespace gicodec
