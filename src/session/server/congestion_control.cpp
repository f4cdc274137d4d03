#include "session/server/congestion_control.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gicodec {
namespace {

constexpr double kMinBytes = 2 << 10;
// Queueing delays, in intervals between updates. With an update's own time they stay below three.
constexpr double kEmpty = 0.5;  ///< up to here budgets grow fast, those of new clients faster still
constexpr double kGood = 1;     ///< up to here they grow evenly, so that shares become even
constexpr double kFull = 1.5;   ///< from here on they shrink
constexpr double kTooLate = 1.75;  ///< no update while an older one is in flight for longer
constexpr double kShrink = 0.85, kShrinkOfMany = 0.7, kMany = 2, kMaxShrink = 0.1;
constexpr double kGrowth = 0.05;  // of the mean
constexpr double kMaxGrowth = 0.25;
constexpr double kMaxBytes = 1 << 30;
/// Seconds after which the server lets a busy path become idle, to measure it again.
constexpr double kLookAgain = 10;

}  // namespace

double next_limit_for_few(double before, const WrittenBlocks& written, double seconds,
                          double most) noexcept {
  constexpr double kMinBlocks = 1.0 / 64, kNoLimit = 1 << 30, kAim = 0.7, kMinStep = 1.0 / 16,
                   kMaxStep = 1.25;
  // Packets for all take what they need, but leave this share of the time to packets for few.
  constexpr double kMinShare = 0.15;
  const auto few = static_cast<double>(written.for_few);
  if (before == 0 && (seconds <= most || few == 0)) return 0;
  // Examining blocks takes the same time however few are written.
  constexpr double kLooks = 64;  // blocks examined in the time of writing one
  const double all =
      static_cast<double>(written.all) + static_cast<double>(written.examined) / kLooks;
  const double spent = all > 0 ? seconds * few / all : 0;
  const double left = std::max(kAim * most - (seconds - spent), kMinShare * most);
  const double from = few > 0 && (before == 0 || seconds > most) ? few : before;
  const double step = std::clamp(left / std::max(spent, 1e-9), kMinStep, kMaxStep);
  const double blocks = std::max(kMinBlocks, from * step);
  return blocks > kNoLimit ? 0 : blocks;
}

CongestionControl::CongestionControl(std::uint64_t first) noexcept
    : first_(std::clamp(static_cast<double>(first), kMinBytes, kMaxBytes)), bytes_(first_) {}

void CongestionControl::answered(double seconds, double now) noexcept {
  if (idle_ >= 0 && seconds > idle_) return;
  idle_ = std::max(seconds, 0.0);
  idle_at_ = now;
}

std::optional<std::uint64_t> CongestionControl::budget(double now, std::optional<double> oldest,
                                                       std::uint64_t bytes_in_flight,
                                                       double interval) noexcept {
  const auto all = static_cast<std::uint64_t>(bytes_);
  looking_ = looking_ || (limited_ && idle_ >= 0 && now - idle_at_ > kLookAgain);
  if (!oldest) return std::exchange(looking_, false) ? 0 : all;
  if (looking_) return std::nullopt;
  const double in_flight = static_cast<double>(bytes_in_flight);
  if (idle_ < 0) return in_flight < first_ ? std::optional(all) : std::nullopt;
  if (now - *oldest > idle_ + kTooLate * interval) return std::nullopt;
  if (interval > 0 && in_flight > bytes_ * (idle_ / interval + kFull)) return std::nullopt;
  return all;
}

void CongestionControl::acknowledged(const Sent& update, double now, double interval,
                                     double mean) noexcept {
  const double latency = std::max(now - update.made, 0.0);
  delivered_ += update.bytes;
  limited_ = update.limited;
  if (update.alone && update.empty) idle_ = -1;
  answered(latency, now);
  // Updates arrive one after the other. Small ones say little.
  const double began = std::max(update.made + idle_, std::exchange(acknowledged_, now));
  constexpr std::uint64_t kMeasurable = 256;
  if (update.bytes >= kMeasurable) {
    constexpr double kWeight = 1.0 / 8;
    update_bytes_ += kWeight * (static_cast<double>(update.bytes) - update_bytes_);
    seconds_ += kWeight * (std::max(now - began, 0.0) - seconds_);
  }
  if (update.made < changed_ || interval <= 0) return;
  const double queue = (latency - idle_) / interval;
  if (queue > kFull) {
    // Bytes that were queued before this update have arrived meanwhile.
    const double rate = static_cast<double>(delivered_ - update.delivered) / (latency - idle_);
    const double shrink = bytes_ > kMany * mean ? kShrinkOfMany : kShrink;
    bytes_ = std::clamp(shrink * rate * interval, kMaxShrink * bytes_, shrink * bytes_);
    bytes_ = std::max(bytes_, kMinBytes);
  } else if (!update.limited || queue > (update.alone ? kFull : kGood)) {
    return;
  } else if (queue <= kEmpty && (starting_ || bytes_ <= mean)) {
    // A small update says little about the path's capacity.
    const bool much = static_cast<double>(update.bytes) >= bytes_ / 2;
    bytes_ *= !starting_ ? 1 + kMaxGrowth : much ? 2 : 1;
  } else {
    // Budgets grow as fast on long paths as on short ones.
    bytes_ += std::clamp(kGrowth * mean * std::max(1.0, idle_ / interval), kMinBytes / 4,
                         kMaxGrowth * bytes_);
  }
  bytes_ = std::min(bytes_, kMaxBytes);
  starting_ = starting_ && queue <= kEmpty;
  changed_ = now;
}

double CongestionControl::throughput() const noexcept {
  if (update_bytes_ == 0) return 0;
  return seconds_ > 0 ? update_bytes_ / seconds_ : std::numeric_limits<double>::infinity();
}

}  // namespace gicodec
