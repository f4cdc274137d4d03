#include "charts.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <tuple>

namespace gicodec::maps {
namespace {

using namespace ddgi;

constexpr float kLikeNormals = 0.8F;  // cosine to the first triangle's: stretches by 1.25 at most
constexpr float kLargest = 0.3F;      // side of a chart beside that of all surfaces as a square
constexpr float kDensityOutside = 0.25F;  // of charts outside of where light is looked at

/// Triangles across each of a triangle's edges, as a list for each.
struct Neighbours {
  std::vector<std::uint32_t> begin, list;
};

/// Corners at the same place count as one: meshes part them where normals or images do.
std::vector<std::uint32_t> weld(const std::vector<Vec3>& positions) {
  std::vector<std::uint32_t> order(positions.size()), same(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t i) {
    return std::tuple(positions[i].x, positions[i].y, positions[i].z, i);
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool first = i == 0 || !(positions[order[i]] == positions[order[i - 1]]);
    same[order[i]] = first ? order[i] : same[order[i - 1]];
  }
  return same;
}

Neighbours find_neighbours(const Mesh& mesh) {
  struct Edge {
    std::uint32_t a, b, triangle;
  };
  const std::vector<std::uint32_t> corner = weld(mesh.positions);
  std::vector<Edge> edges;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = corner[mesh.triangles[t][i]];
      const std::uint32_t b = corner[mesh.triangles[t][(i + 1) % 3]];
      edges.push_back({std::min(a, b), std::max(a, b), t});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& l, const Edge& r) {
    return std::tie(l.a, l.b, l.triangle) < std::tie(r.a, r.b, r.triangle);
  });
  // Of edges where more than two meet, each triangle has the one before and the one behind it.
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (std::size_t i = 1; i < edges.size(); ++i) {
    if (edges[i].a != edges[i - 1].a || edges[i].b != edges[i - 1].b) continue;
    pairs.push_back({edges[i - 1].triangle, edges[i].triangle});
    pairs.push_back({edges[i].triangle, edges[i - 1].triangle});
  }
  std::sort(pairs.begin(), pairs.end());
  Neighbours out;
  out.begin.assign(mesh.triangles.size() + 1, 0);
  for (const auto& [from, to] : pairs) {
    ++out.begin[from + 1];
    out.list.push_back(to);
  }
  std::partial_sum(out.begin.begin(), out.begin.end(), out.begin.begin());
  return out;
}

Vec2 on_plane(const Chart& chart, Vec3 p) { return {dot(p, chart.u), dot(p, chart.v)}; }

class Cutter {
 public:
  explicit Cutter(const Scene& scene) : scene_(scene) {}

  SceneCharts run() {
    for (std::uint32_t o = 0; o < scene_.objects.size(); ++o) {
      for (const std::uint32_t m : scene_.objects[o].meshes) add_instance(o, m);
    }
    double area = 0;
    for (const auto& [a, b, c] : out_.positions) area += length(cross(b - a, c - a)) / 2;
    most_ = kLargest * static_cast<float>(std::sqrt(area));
    out_.chart_of.assign(out_.positions.size(), SceneCharts::kNone);
    for (const Instance& instance : out_.instances) cut(instance);
    return std::move(out_);
  }

 private:
  void add_instance(std::uint32_t object, std::uint32_t number) {
    const Mesh& mesh = scene_.meshes[number];
    const Affine& place = scene_.objects[object].transform;
    const bool mirrored = place.determinant() < 0;
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    out_.instances.push_back(
        {object, number, static_cast<std::uint32_t>(out_.positions.size()), count});
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 p = place.point(mesh.positions[a]), q = place.point(mesh.positions[b]),
                 r = place.point(mesh.positions[c]);
      out_.positions.push_back({p, q, r});
      const Vec3 normal = normalize(cross(q - p, r - p));
      normals_.push_back(mirrored ? -normal : normal);
    }
  }

  void cut(const Instance& instance) {
    const Neighbours near = find_neighbours(scene_.meshes[instance.mesh]);
    for (std::uint32_t seed = 0; seed < instance.triangles; ++seed) {
      if (out_.chart_of[instance.first + seed] != SceneCharts::kNone) continue;
      const Vec3 normal = normals_[instance.first + seed];
      if (!(dot(normal, normal) > 0.5F)) continue;  // without an area
      grow(instance, near, seed);
    }
  }

  void grow(const Instance& instance, const Neighbours& near, std::uint32_t seed) {
    const auto number = static_cast<std::uint32_t>(out_.charts.size());
    Chart chart;
    chart.normal = normals_[instance.first + seed];
    basis(chart.normal, chart.u, chart.v);
    Vec2 lo{1e30F, 1e30F}, hi{-1e30F, -1e30F};
    Box box;
    std::vector<std::uint32_t>& members = chart.triangles;
    const auto take = [&](std::uint32_t triangle) {
      const std::uint32_t all = instance.first + triangle;
      if (out_.chart_of[all] != SceneCharts::kNone ||
          !(dot(normals_[all], chart.normal) >= kLikeNormals)) {
        return;
      }
      Vec2 l = lo, h = hi;
      for (const Vec3 p : out_.positions[all]) {
        const Vec2 at = on_plane(chart, p);
        l = {std::min(l.x, at.x), std::min(l.y, at.y)};
        h = {std::max(h.x, at.x), std::max(h.y, at.y)};
      }
      if (!members.empty() && std::max(h.x - l.x, h.y - l.y) > most_) return;
      lo = l, hi = h;
      for (const Vec3 p : out_.positions[all]) box.add(p);
      out_.chart_of[all] = number;
      members.push_back(all);
    };
    take(seed);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const std::uint32_t triangle = members[i] - instance.first;
      for (std::uint32_t n = near.begin[triangle]; n < near.begin[triangle + 1]; ++n) {
        take(near.list[n]);
      }
    }
    chart.least = lo;
    chart.size = {hi.x - lo.x, hi.y - lo.y};
    chart.density = is_outside(box) ? kDensityOutside : 1;
    out_.charts.push_back(std::move(chart));
  }

  /// Whether a chart that never moves lies outside of the scene's volume.
  [[nodiscard]] bool is_outside(const Box& box) const {
    const Box& volume = scene_.volume;
    if (volume.empty()) return false;
    const Vec3 margin = volume.size() * 0.1F;
    const Vec3 lo = volume.lo - margin, hi = volume.hi + margin;
    return box.hi.x < lo.x || box.hi.y < lo.y || box.hi.z < lo.z || box.lo.x > hi.x ||
           box.lo.y > hi.y || box.lo.z > hi.z;
  }

  const Scene& scene_;
  SceneCharts out_;
  std::vector<Vec3> normals_;
  float most_ = 0;
};

}  // namespace

SceneCharts make_charts(const Scene& scene) { return Cutter(scene).run(); }

}  // namespace gicodec::maps
