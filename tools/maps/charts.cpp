#include "charts.h"

#include <algorithm>
#include <map>

namespace gicodec::maps {
namespace {

using namespace ddgi;

constexpr float kLikeNormals = 0.8F;  // cosine to the first triangle's: stretches by 1.25 at most
constexpr float kLargest = 0.3F;      // side of a chart beside that of all surfaces as a square
constexpr float kDensityOutside = 0.25F;  // of charts outside of where light is looked at

/// Corners at the same place count as one: meshes part them where normals or images do.
std::vector<std::uint32_t> weld(const std::vector<Vec3>& positions) {
  std::map<std::array<float, 3>, std::uint32_t> first;
  std::vector<std::uint32_t> same;
  for (const Vec3 p : positions) {
    const auto number = static_cast<std::uint32_t>(same.size());
    same.push_back(first.try_emplace({p.x, p.y, p.z}, number).first->second);
  }
  return same;
}

/// By triangle those across its edges, ascending.
std::vector<std::vector<std::uint32_t>> find_neighbours(const Mesh& mesh) {
  struct Edge {
    std::uint32_t a, b, triangle;
    auto operator<=>(const Edge&) const = default;
  };
  const std::vector<std::uint32_t> corner = weld(mesh.positions);
  std::vector<Edge> edges;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] =
          std::minmax(corner[mesh.triangles[t][i]], corner[mesh.triangles[t][(i + 1) % 3]]);
      edges.push_back({a, b, t});
    }
  }
  std::sort(edges.begin(), edges.end());
  // Of edges where more than two meet, each triangle has the one before and the one behind it.
  std::vector<std::vector<std::uint32_t>> near(mesh.triangles.size());
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const Edge &one = edges[i - 1], &other = edges[i];
    if (one.a != other.a || one.b != other.b) continue;
    near[one.triangle].push_back(other.triangle);
    near[other.triangle].push_back(one.triangle);
  }
  for (std::vector<std::uint32_t>& list : near) std::sort(list.begin(), list.end());
  return near;
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
    const auto near = find_neighbours(scene_.meshes[instance.mesh]);
    for (std::uint32_t seed = 0; seed < instance.triangles; ++seed) {
      if (out_.chart_of[instance.first + seed] != SceneCharts::kNone) continue;
      const Vec3 normal = normals_[instance.first + seed];
      if (!(dot(normal, normal) > 0.5F)) continue;  // without an area
      grow(instance, near, seed);
    }
  }

  void grow(const Instance& instance, const std::vector<std::vector<std::uint32_t>>& near,
            std::uint32_t seed) {
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
      for (const std::uint32_t n : near[members[i] - instance.first]) take(n);
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
