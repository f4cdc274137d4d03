// Shared rate: how often a client takes part in shared streams, in every 1st, 2nd, 4th, ... update,
// so that on average it gets no more than its budget. With few streams, clients form up to four
// groups that take turns. Clients of the same group and rate take part in the same updates, and
// slower ones in some of these, so that they share packets.
#pragma once

#include <gicodec/delivery.h>

#include <cstddef>
#include <cstdint>

namespace gicodec {

/// Assumed compression ratio before the first packet.
inline constexpr float kGuessedRatio = 3;

class SharedRate {
 public:
  explicit SharedRate(std::uint32_t group) noexcept : group_(group) {}

  /// Chooses the rate before an update. `streams`: the number of the client's streams.
  void choose(const Budget& budget, std::size_t streams, std::size_t bytes_of_a_stream) noexcept;
  /// True if the client takes part in a stream in this update. `place` numbers the streams.
  [[nodiscard]] bool turn(std::uint64_t update, std::size_t place) const noexcept;
  /// The client takes part in the stream in every 2^tier-th update.
  [[nodiscard]] unsigned tier(std::size_t place) const noexcept;
  /// True if the client takes part in less than all updates.
  [[nodiscard]] bool slowed() const noexcept { return tier_ > 0 || faster_ < 1; }
  /// The share of all packets that the client gets, 0 to 1.
  [[nodiscard]] float share() const noexcept { return share_; }
  /// Reports an update: the streams whose turn it was, and the bytes and blocks of their packets.
  void sent(std::size_t turns, std::size_t bytes, std::size_t blocks) noexcept;

 private:
  static constexpr unsigned kSlowest = 5;  ///< every 32nd update

  std::uint32_t group_, groups_ = 1;
  float bytes_ = 0, blocks_ = 0;  ///< per turn, recent mean
  bool measured_ = false;
  std::size_t streams_ = 0;
  unsigned tier_ = 0;  ///< every 2^tier-th update; twice as often for the share faster_ of streams
  float faster_ = 1, share_ = 1;
};

}  // namespace gicodec
