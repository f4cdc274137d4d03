#include "radius.h"

#include "kinds/tracing.h"

#include <algorithm>
#include <numeric>
#include <queue>

namespace gicodec::photons {
namespace {

using ddgi::Vec3;

using kinds::coordinate;

/// A balanced k-d tree: the middle of a range of points is its node, what lies before and behind
/// are its children; axes take turns.
class Tree {
 public:
  explicit Tree(std::span<const Vec3> points) : points_(points), order_(points.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    build(0, points.size(), 0);
  }

  /// Squared distance to the count-th nearest point other than `self` itself.
  [[nodiscard]] float nearest(std::uint32_t self, std::uint32_t count, float most) const {
    Query query{points_[self], self, count, most * most, {}};
    search(0, order_.size(), 0, query);
    return query.reach;
  }

 private:
  struct Query {
    Vec3 at;
    std::uint32_t self, count;
    float reach;                       ///< squared; what is not nearer does not count
    std::priority_queue<float> found;  ///< squared distances, the largest first
  };

  void build(std::size_t begin, std::size_t end, unsigned axis) {
    if (end - begin < 2) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      return coordinate(points_[a], axis) < coordinate(points_[b], axis);
    });
    build(begin, middle, (axis + 1) % 3);
    build(middle + 1, end, (axis + 1) % 3);
  }

  void search(std::size_t begin, std::size_t end, unsigned axis, Query& query) const {
    if (begin == end) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const Vec3 d = points_[order_[middle]] - query.at;
    const float side = coordinate(d, axis);
    const unsigned next = (axis + 1) % 3;
    const auto before = [&] { search(begin, middle, next, query); };
    const auto behind = [&] { search(middle + 1, end, next, query); };
    side > 0 ? before() : behind();
    if (order_[middle] != query.self) look_at(ddgi::dot(d, d), query);
    if (side * side < query.reach) side > 0 ? behind() : before();
  }

  static void look_at(float squared, Query& query) {
    if (squared >= query.reach) return;
    query.found.push(squared);
    if (query.found.size() > query.count) query.found.pop();
    if (query.found.size() == query.count) query.reach = query.found.top();
  }

  std::span<const Vec3> points_;
  std::vector<std::uint32_t> order_;
};

}  // namespace

std::vector<float> neighbour_distances(std::span<const Vec3> points, std::uint32_t neighbours,
                                       float most, ddgi::ThreadPool& pool) {
  const Tree tree(points);
  std::vector<float> distances(points.size());
  kinds::for_all(points.size(), pool, [&](std::size_t i) {
    distances[i] = std::sqrt(tree.nearest(static_cast<std::uint32_t>(i), neighbours, most));
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
