#include "sample_elimination.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace gicodec::ao {
namespace {

using ddgi::Vec3;

constexpr std::size_t kChunk = 4096;

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
    constexpr float kMost = (1 << 21) - 3;
    const Vec3 c = (p - low_) / reach_;
    const auto whole = [=](float v) {
      return static_cast<std::int64_t>(std::clamp(v, 0.0F, kMost)) + 1;
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

/// Samples by weight, the heaviest on top.
class Heap {
 public:
  explicit Heap(std::vector<float>& weights) : weights_(weights) {
    order_.resize(weights.size());
    std::iota(order_.begin(), order_.end(), 0U);
    place_ = order_;
    for (std::size_t i = order_.size() / 2; i-- > 0;) sink(i);
  }

  std::uint32_t pop() {
    const std::uint32_t top = order_.front();
    swap(0, order_.size() - 1);
    order_.pop_back();
    place_[top] = kGone;
    if (!order_.empty()) sink(0);
    return top;
  }
  /// Nothing where the sample is gone.
  void lighten(std::uint32_t sample, float weight) {
    if (place_[sample] == kGone) return;
    weights_[sample] -= weight;
    sink(place_[sample]);
  }
  [[nodiscard]] bool has(std::uint32_t sample) const { return place_[sample] != kGone; }

 private:
  static constexpr std::uint32_t kGone = ~0U;

  [[nodiscard]] bool heavier(std::uint32_t a, std::uint32_t b) const {
    return weights_[a] != weights_[b] ? weights_[a] > weights_[b] : a > b;
  }
  void swap(std::size_t a, std::size_t b) {
    std::swap(order_[a], order_[b]);
    place_[order_[a]] = static_cast<std::uint32_t>(a);
    place_[order_[b]] = static_cast<std::uint32_t>(b);
  }
  void sink(std::size_t at) {
    for (;;) {
      std::size_t best = at;
      for (const std::size_t child : {2 * at + 1, 2 * at + 2}) {
        if (child < order_.size() && heavier(order_[child], order_[best])) best = child;
      }
      if (best == at) return;
      swap(at, best);
      at = best;
    }
  }

  std::vector<float>& weights_;
  std::vector<std::uint32_t> order_, place_;
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
  pool.run((samples.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(samples.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      float sum = 0;
      neighbours.visit(static_cast<std::uint32_t>(i),
                       [&](std::uint32_t, float d) { sum += weight(d, reach); });
      weights[i] = sum;
    }
  });
  Heap heap(weights);
  for (std::size_t left = samples.size(); left > keep; --left) {
    neighbours.visit(heap.pop(),
                     [&](std::uint32_t i, float d) { heap.lighten(i, weight(d, reach)); });
  }
  std::vector<std::uint32_t> kept;
  kept.reserve(keep);
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    if (heap.has(i)) kept.push_back(i);
  }
  return kept;
}

}  // namespace gicodec::ao
