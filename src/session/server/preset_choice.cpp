#include "session/server/preset_choice.h"

#include <algorithm>
#include <numeric>

namespace gicodec {
namespace {

/// What native takes for a model: seconds per byte of records, with 1 ns for all else that a server
/// does for a client, and bytes by those of "fast".
struct ModelCosts {
  Model model;
  ByPreset seconds, bytes;
};
constexpr std::array kCosts{
    ModelCosts{Model::none, {1.5e-9, 5e-9, 41e-9}, {1.4, 1, 0.97}},
    ModelCosts{Model::stacked, {1.5e-9, 5e-9, 13e-9}, {1.3, 1, 0.98}},
    ModelCosts{Model::continuous, {1.5e-9, 5e-9, 101e-9}, {1.6, 1, 0.85}},
    ModelCosts{Model::unordered, {51e-9, 51e-9, 101e-9}, {1, 1, 0.99}},
    ModelCosts{Model::octree, {51e-9, 51e-9, 101e-9}, {1, 1, 0.99}},
    ModelCosts{Model::hemispheres, {1.5e-9, 51e-9, 51e-9}, {1.4, 1, 0.99}},
};
constexpr const ModelCosts& row(Model model) { return kCosts[static_cast<std::size_t>(model)]; }
static_assert(std::all_of(kCosts.begin(), kCosts.end(),
                          [](const ModelCosts& one) { return &row(one.model) == &one; }));

constexpr bool in_order(const ModelCosts& one) noexcept {
  return std::is_sorted(one.seconds.begin(), one.seconds.end()) &&
         std::is_sorted(one.bytes.rbegin(), one.bytes.rend());
}
static_assert(std::all_of(kCosts.begin(), kCosts.end(), in_order));

constexpr double kRecentWeight = 1.0 / 8;  ///< of an update in recent means

/// The first of the presets up to `slowest` that delivers soonest.
std::size_t best(const PresetCosts& costs, double throughput, const ByPreset& pace,
                 std::size_t slowest) noexcept {
  const auto seconds = [&](std::size_t preset) {
    return pace[preset] * costs.seconds[preset] + costs.bytes[preset] / throughput;
  };
  std::size_t found = kTurbo;
  for (std::size_t preset = kTurbo + 1; preset <= slowest; ++preset) {
    if (seconds(preset) < seconds(found)) found = preset;
  }
  return found;
}

}  // namespace

void PresetCosts::add(const TextureDesc& desc, std::size_t blocks, std::size_t size,
                      std::size_t preset, double share) noexcept {
  const ModelCosts& of = row(desc.model);
  const auto records = static_cast<double>(blocks) * static_cast<double>(block_bytes(desc));
  for (std::size_t i = 0; i < kPresets.size(); ++i) {
    seconds[i] += records * of.seconds[i];
    bytes[i] += share * static_cast<double>(size) * of.bytes[i] / of.bytes[preset];
  }
}

void PresetCosts::add(const PresetCosts& other) noexcept {
  for (std::size_t i = 0; i < kPresets.size(); ++i) {
    seconds[i] += other.seconds[i];
    bytes[i] += other.bytes[i];
  }
}

/// Presets that are in use learn their pace soon; others forget it slowly, and are tried again.
void ProcessorTime::learn(double elapsed, const ByPreset& coded, double other) noexcept {
  constexpr double kMeasurable = 1e-4;  ///< seconds; less says little about coding
  constexpr double kForget = 1.0 / 256, kMin = 1.0 / 8, kMax = 64;
  const double all = std::accumulate(coded.begin(), coded.end(), 0.0);
  if (all < kMeasurable) return;
  const double pace = std::clamp(elapsed / (all + other), kMin, kMax);
  for (std::size_t i = 0; i < kPresets.size(); ++i) {
    const double share = coded[i] / (all + other);
    const double weight = measured_[i] ? std::max(kRecentWeight * share, kForget) : 1;
    pace_[i] += weight * (pace - pace_[i]);
    measured_[i] = measured_[i] || 2 * share > 1;
  }
}

void ProcessorTime::report(double elapsed, double budget, const ByPreset& coded,
                           double other) noexcept {
  constexpr double kRoom = 0.5;  ///< of the budget: leaves time for a slower preset
  constexpr std::uint32_t kMaxWait = 1024;
  learn(elapsed, coded, other);
  ++in_time_;
  if (elapsed > budget) {
    if (slowest_ != kTurbo) wait_[slowest_] = std::min(2 * wait_[slowest_], kMaxWait);
    slowest_ = kTurbo;
    in_time_ = 0;
  } else if (slowest_ < kStrong) {
    if (elapsed > kRoom * budget || in_time_ < wait_[slowest_ + 1]) return;
    ++slowest_;
    in_time_ = 0;
  } else if (in_time_ >= kMaxWait) {
    wait_.fill(kMinWait);
  }
}

void PresetChoice::choose(const PresetCosts& last, double throughput, const ByPreset& pace,
                          std::size_t slowest) noexcept {
  constexpr double kMargin = 1.25;
  constexpr std::uint32_t kUpdates = 8;
  if (preset_ > slowest) {
    preset_ = wish_ = slowest;
    wished_ = 0;
  }
  if (throughput <= 0 || last.bytes[kFast] <= 0) return;
  const double weight = recent_.bytes[kFast] == 0 ? 1 : kRecentWeight;
  for (std::size_t i = 0; i < kPresets.size(); ++i) {
    recent_.seconds[i] += weight * (last.seconds[i] - recent_.seconds[i]);
    recent_.bytes[i] += weight * (last.bytes[i] - recent_.bytes[i]);
  }
  // The higher the throughput, the faster the best preset.
  const std::size_t high = best(recent_, throughput * kMargin, pace, slowest);
  const std::size_t low = best(recent_, throughput / kMargin, pace, slowest);
  const std::size_t wish = high > preset_ ? high : low < preset_ ? low : preset_;
  wished_ = wish == wish_ ? wished_ + 1 : 1;
  wish_ = wish;
  if (wish != preset_ && wished_ >= kUpdates) preset_ = wish;
}

double low_throughput(std::span<double> throughputs) noexcept {
  constexpr std::size_t kOneOf = 10;
  const std::size_t clients = throughputs.size();
  if (clients == 0) return 0;
  const std::size_t below = clients == 1 ? 0 : std::max<std::size_t>(1, clients / kOneOf);
  const auto chosen = throughputs.begin() + static_cast<std::ptrdiff_t>(below);
  std::nth_element(throughputs.begin(), chosen, throughputs.end());
  return *chosen;
}

}  // namespace gicodec
