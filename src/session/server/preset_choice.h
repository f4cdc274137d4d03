// Which preset of the native backend packets have: the one that delivers them first. An update
// takes the time of coding it, which reported times correct, and that of its bytes at a client's
// throughput. Clients acknowledge what they have decoded, so that throughput contains their time.
#pragma once

#include <gicodec/texture.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace gicodec {

/// From fast to slow.
inline constexpr std::array<std::string_view, 3> kPresets{"turbo", "fast", "strong"};
inline constexpr std::size_t kTurbo = 0, kFast = 1, kStrong = 2;

using ByPreset = std::array<double, kPresets.size()>;

/// What packets take, by preset: seconds of coding on a usual core, and bytes for each client.
struct PresetCosts {
  /// For each byte of records that is published, coded or not.
  static constexpr double kPublished = 1e-9;
  ByPreset seconds{}, bytes{};

  /// Adds a packet of so many blocks that took `size` bytes in `preset` and goes to this share of
  /// the clients.
  void add(const TextureDesc& desc, std::size_t blocks, std::size_t size, std::size_t preset,
           double share = 1) noexcept;
  void add(const PresetCosts& other) noexcept;
};

/// What the server has time for, by the times of its updates.
class ProcessorTime {
 public:
  /// An update took `elapsed` of `budget` seconds; `coded`: the seconds of PresetCosts of its
  /// packets, by the preset that they have; `other`: such seconds for all else.
  void report(double elapsed, double budget, const ByPreset& coded, double other = 0) noexcept;
  /// Seconds that coding takes here for one of PresetCosts.
  [[nodiscard]] const ByPreset& pace() const noexcept { return pace_; }
  /// The slowest preset that there is time for: turbo after an update beyond its budget, then
  /// slower ones while updates leave time. Fast until there is a report.
  [[nodiscard]] std::size_t slowest() const noexcept { return slowest_; }

 private:
  static constexpr std::uint32_t kMinWait = 8;

  void learn(double elapsed, const ByPreset& coded, double other) noexcept;

  std::size_t slowest_ = kFast;
  std::uint32_t in_time_ = 0;  ///< updates within their budgets since `slowest_` changed
  /// Such updates before a preset is tried, longer after each time that it took too long.
  std::array<std::uint32_t, kPresets.size()> wait_{kMinWait, kMinWait, kMinWait};
  ByPreset pace_{1, 1, 1};
  std::array<bool, kPresets.size()> measured_{};  ///< else a preset has the pace of others
};

/// The preset of a client's unicast packets, or of all shared ones.
class PresetChoice {
 public:
  [[nodiscard]] std::size_t preset() const noexcept { return preset_; }
  /// Call before an update. `last`: the packets of the one before. `throughput`: bytes per second;
  /// 0: not known. A preset beyond `slowest` is left at once; else the preset changes after several
  /// updates in which another one is the best, also for a throughput higher or lower by a quarter.
  void choose(const PresetCosts& last, double throughput, const ByPreset& pace,
              std::size_t slowest) noexcept;

 private:
  PresetCosts recent_;  ///< mean of updates
  std::size_t preset_ = kFast, wish_ = kFast;
  std::uint32_t wished_ = 0;  ///< updates
};

/// The throughput that shared packets are made for, of those of their clients; 0 for none. A tenth
/// of the clients, and at least one of two or more, may have less: a single client, slow or lying,
/// only moves the choice from one honest client to the next. Reorders `throughputs`.
[[nodiscard]] double low_throughput(std::span<double> throughputs) noexcept;

}  // namespace gicodec
