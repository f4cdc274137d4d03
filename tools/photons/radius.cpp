#include "radius.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace gicodec::photons {
namespace {

using ddgi::Vec3;

float coordinate(Vec3 v, std::uint32_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// A balanced k-d tree: the middle of a range of points is its node, what lies before and behind
/// are its children. Small ranges are looked through.
class Tree {
 public:
  explicit Tree(std::span<const Vec3> points) : points_(points), order_(points.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    axes_.resize(points.size());
    build(0, points.size());
  }

  /// Squared distance to the count-th nearest point other than `self` itself.
  [[nodiscard]] float nearest(std::uint32_t self, std::uint32_t count, float most) const {
    Query query{points_[self], self, count, most * most, {}};
    query.found.reserve(count + 1);
    search(0, order_.size(), query);
    return query.reach;
  }

 private:
  static constexpr std::size_t kLeaf = 8;

  struct Query {
    Vec3 at;
    std::uint32_t self, count;
    float reach;               ///< squared; what is not nearer does not count
    std::vector<float> found;  ///< a heap of squared distances, the largest first
  };

  void build(std::size_t begin, std::size_t end) {
    if (end - begin <= kLeaf) return;
    ddgi::Box box;
    for (std::size_t i = begin; i < end; ++i) box.add(points_[order_[i]]);
    const Vec3 size = box.size();
    const std::uint8_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      const float x = coordinate(points_[a], axis), y = coordinate(points_[b], axis);
      return x != y ? x < y : a < b;
    });
    axes_[middle] = axis;
    build(begin, middle);
    build(middle + 1, end);
  }

  void look_at(std::size_t place, Query& query) const {
    if (order_[place] == query.self) return;
    const Vec3 d = points_[order_[place]] - query.at;
    const float squared = ddgi::dot(d, d);
    if (squared >= query.reach) return;
    auto& found = query.found;
    found.push_back(squared);
    std::push_heap(found.begin(), found.end());
    if (found.size() > query.count) {
      std::pop_heap(found.begin(), found.end());
      found.pop_back();
    }
    if (found.size() == query.count) query.reach = found.front();
  }

  void search(std::size_t begin, std::size_t end, Query& query) const {
    if (end - begin <= kLeaf) {
      for (std::size_t i = begin; i < end; ++i) look_at(i, query);
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    const float side =
        coordinate(query.at, axes_[middle]) - coordinate(points_[order_[middle]], axes_[middle]);
    const std::array<std::size_t, 2> low{begin, middle}, high{middle + 1, end};
    const auto& near = side < 0 ? low : high;
    const auto& far = side < 0 ? high : low;
    search(near[0], near[1], query);
    look_at(middle, query);
    if (side * side < query.reach) search(far[0], far[1], query);
  }

  std::span<const Vec3> points_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint8_t> axes_;  ///< by place in the order, of nodes
};

}  // namespace

std::vector<float> neighbour_distances(std::span<const Vec3> points, std::uint32_t neighbours,
                                       float most, ddgi::ThreadPool& pool) {
  constexpr std::size_t kRun = 256;
  const Tree tree(points);
  std::vector<float> distances(points.size());
  pool.run((points.size() + kRun - 1) / kRun, [&](std::size_t run) {
    const std::size_t end = std::min(points.size(), (run + 1) * kRun);
    for (std::size_t i = run * kRun; i < end; ++i) {
      distances[i] = std::sqrt(tree.nearest(static_cast<std::uint32_t>(i), neighbours, most));
    }
  });
  return distances;
}

float round_fraction(float value, std::uint32_t bits) {
  int exponent = 0;
  const float fraction = std::frexp(value, &exponent);
  const auto steps = static_cast<float>(2U << bits);
  return std::ldexp(std::floor(fraction * steps + 0.5F) / steps, exponent);
}

}  // namespace gicodec::photons
