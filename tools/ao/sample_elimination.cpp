#include "sample_elimination.h"

#include "kinds/tracing.h"

#include <array>
#include <queue>
#include <utility>

namespace gicodec::ao {
namespace {

using ddgi::Vec3;

/// Samples by cells as wide as weights reach.
class Neighbours {
 public:
  Neighbours(std::span<const SurfacePoint> samples, float reach)
      : samples_(samples), reach_(reach) {
    ddgi::Box box;
    for (const SurfacePoint& sample : samples) box.add(sample.position);
    low_ = box.lo;
    places_.resize(samples.size());
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
      places_[i] = {key(cell(samples[i].position)), i};
    }
    std::ranges::sort(places_);
  }

  /// visit(index, distance) for each neighbour of sample `i`, always in the same order.
  template <typename Visit>
  void visit(std::uint32_t i, const Visit& visit) const {
    const SurfacePoint& at = samples_[i];
    const auto [x, y, z] = cell(at.position);
    for (std::int64_t dz = -1; dz <= 1; ++dz) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const std::uint64_t last = key({x + 1, y + dy, z + dz});
        auto place =
            std::ranges::lower_bound(places_, key({x - 1, y + dy, z + dz}), {}, &Place::key);
        for (; place != places_.end() && place->key <= last; ++place) {
          const SurfacePoint& other = samples_[place->index];
          const float distance = length(other.position - at.position);
          if (place->index != i && distance < reach_ && dot(other.normal, at.normal) > 0) {
            visit(place->index, distance);
          }
        }
      }
    }
  }

 private:
  struct Place {
    std::uint64_t key;
    std::uint32_t index;
    friend auto operator<=>(const Place&, const Place&) = default;
  };
  using Cell = std::array<std::int64_t, 3>;

  [[nodiscard]] Cell cell(Vec3 p) const {
    constexpr float kMax = (1 << 21) - 3;
    const Vec3 c = (p - low_) / reach_;
    const auto whole = [=](float v) {
      return static_cast<std::int64_t>(std::clamp(v, 0.0F, kMax)) + 1;
    };
    return {whole(c.x), whole(c.y), whole(c.z)};
  }
  [[nodiscard]] static std::uint64_t key(const Cell& c) {
    return static_cast<std::uint64_t>(c[2] << 42 | c[1] << 21 | c[0]);
  }

  std::span<const SurfacePoint> samples_;
  float reach_;
  Vec3 low_;
  std::vector<Place> places_;  ///< sorted
};

float weight(float distance, float reach) {
  const float w = 1 - distance / reach, w2 = w * w, w4 = w2 * w2;
  return w4 * w4;
}

}  // namespace

float largest_radius(double area, double count) {
  return static_cast<float>(std::sqrt(area / (2 * std::sqrt(3.0) * count)));
}

std::vector<std::uint32_t> eliminate(std::span<const SurfacePoint> samples, std::size_t keep,
                                     float r_max, ddgi::ThreadPool& pool) {
  const float reach = 2 * r_max;
  const Neighbours neighbours(samples, reach);
  std::vector<float> weights(samples.size());
  kinds::for_all(samples.size(), pool, [&](std::size_t i) {
    neighbours.visit(static_cast<std::uint32_t>(i),
                     [&](std::uint32_t, float d) { weights[i] += weight(d, reach); });
  });
  // The heaviest on top. Samples only get lighter: one that did since it was pushed goes back.
  std::priority_queue<std::pair<float, std::uint32_t>> queue;
  for (std::uint32_t i = 0; i < samples.size(); ++i) queue.emplace(weights[i], i);
  std::vector<std::uint8_t> gone(samples.size());
  for (std::size_t left = samples.size(); left > keep;) {
    const auto [at_push, heaviest] = queue.top();
    queue.pop();
    if (weights[heaviest] < at_push) {
      queue.emplace(weights[heaviest], heaviest);
      continue;
    }
    gone[heaviest] = 1;
    --left;
    neighbours.visit(heaviest, [&](std::uint32_t i, float d) { weights[i] -= weight(d, reach); });
  }
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    if (gone[i] == 0) kept.push_back(i);
  }
  return kept;
}

}  // namespace gicodec::ao
