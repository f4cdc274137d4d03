#include "voxelise.h"

#include "voxel_code.h"

#include "dump/error.h"

#include <algorithm>
#include <cmath>

namespace gicodec::voxels {
namespace {

using Point = std::array<double, 3>;

constexpr double kMaxTouched = 16'000'000;  // voxels of level 0, by surface
constexpr double kWider = 1e-9;             // of a box that stands for smaller ones in it
constexpr std::size_t kBatch = 64;          // triangles

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point point(Vec3 v) { return {v.x, v.y, v.z}; }

double area(const Triangle& t) {
  const Point n = cross(minus(point(t[1]), point(t[0])), minus(point(t[2]), point(t[0])));
  return std::sqrt(dot(n, n)) / 2;
}

/// Goes down from a cube of cells to those that a triangle touches.
class Descent {
 public:
  Descent(const VoxelGrid& grid, std::vector<SurfaceVoxel>& out) : grid_(grid), out_(out) {}

  void add(const Triangle& world, Directions faced) {
    faced_ = faced;
    // In units of voxels, so that cells are whole numbers.
    for (std::size_t i = 0; i < 3; ++i) {
      triangle_[i] = (world[i] - grid_.origin) / grid_.size;
    }
    unsigned level = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto [lo, hi] = std::minmax(
          {point(triangle_[0])[axis], point(triangle_[1])[axis], point(triangle_[2])[axis]});
      const double last = grid_.cells[axis] - 1;
      if (!(hi >= 0 && lo <= last + 1)) return;
      lo_[axis] = static_cast<std::uint32_t>(std::clamp(std::ceil(lo) - 1, 0.0, last));
      hi_[axis] = static_cast<std::uint32_t>(std::clamp(std::floor(hi), 0.0, last));
      while (lo_[axis] >> level != hi_[axis] >> level) ++level;
    }
    down({lo_[0] >> level, lo_[1] >> level, lo_[2] >> level}, level);
  }

 private:
  void down(const Cell& cell, unsigned level) {
    const double half = std::ldexp(0.5, static_cast<int>(level));
    Point centre;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if ((cell[axis] + 1) << level <= lo_[axis] || cell[axis] << level > hi_[axis]) return;
      centre[axis] = (2 * cell[axis] + 1) * half;
    }
    if (!overlaps(triangle_, centre, level > 0 ? half * (1 + kWider) : half)) return;
    if (level == 0) {
      out_.push_back({morton_key(cell), faced_});
      return;
    }
    for (std::uint32_t child = 0; child < 8; ++child) {
      down({2 * cell[0] + (child & 1), 2 * cell[1] + (child >> 1 & 1), 2 * cell[2] + (child >> 2)},
           level - 1);
    }
  }

  const VoxelGrid& grid_;
  std::vector<SurfaceVoxel>& out_;
  Triangle triangle_{};
  Directions faced_ = 0;
  Cell lo_{}, hi_{};
};

/// Of those in order: of the same place one is left, with the directions of all.
void unite(std::vector<SurfaceVoxel>& voxels) {
  std::size_t count = 0;
  for (const SurfaceVoxel& voxel : voxels) {
    if (count != 0 && voxels[count - 1].key == voxel.key) {
      voxels[count - 1].faced |= voxel.faced;
    } else {
      voxels[count++] = voxel;
    }
  }
  voxels.resize(count);
}

/// Lookups weigh directions by the squares of the normal's coordinates.
Directions faced_by(Vec3 normal) {
  constexpr float kMin = 0.1F;
  Directions faced = 0;
  for (unsigned d = 0; d < kVoxelDirections; ++d) {
    if (dot(axis_of(d), normal) > kMin) faced |= static_cast<Directions>(1U << d);
  }
  return faced;
}

[[noreturn]] void too_many(float size) {
  tools::fail(tools::Exit::usage,
              "--set size: voxels of {:g} m are too many in this scene; a larger size takes fewer",
              size);
}

}  // namespace

VoxelGrid::VoxelGrid(const ddgi::Box& box, float size_in) : size(size_in) {
  // Walls often stand at round numbers. Where sides of voxels do too, both voxels touch the wall,
  // and one of them sees its inside only.
  constexpr double kOff = 0.43;
  const Point lo = point(box.lo), hi = point(box.hi);
  Point begin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    begin[axis] = (std::floor(lo[axis] / size) - kOff) * size;
    const double count = std::floor((hi[axis] - begin[axis]) / size) + 1;
    if (!(count >= 1 && count <= kMaxCells)) too_many(size);
    cells[axis] = static_cast<std::uint32_t>(count);
  }
  origin = {static_cast<float>(begin[0]), static_cast<float>(begin[1]),
            static_cast<float>(begin[2])};
}

bool overlaps(const Triangle& triangle, const Point& centre, double half) {
  std::array<Point, 3> v;
  for (std::size_t i = 0; i < 3; ++i) v[i] = minus(point(triangle[i]), centre);
  const auto apart = [&](const Point& axis) {
    const double a = dot(v[0], axis), b = dot(v[1], axis), c = dot(v[2], axis);
    const double reach = half * (std::abs(axis[0]) + std::abs(axis[1]) + std::abs(axis[2]));
    return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
  };
  constexpr std::array<Point, 3> kAxes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const std::array<Point, 3> edges{minus(v[1], v[0]), minus(v[2], v[1]), minus(v[0], v[2])};
  for (const Point& axis : kAxes) {
    if (apart(axis)) return false;
  }
  if (apart(cross(edges[0], edges[1]))) return false;
  for (const Point& edge : edges) {
    for (const Point& axis : kAxes) {
      if (apart(cross(edge, axis))) return false;
    }
  }
  return true;
}

Voxeliser::Voxeliser(const ddgi::Scene& scene, const VoxelGrid& grid, ddgi::ThreadPool& pool)
    : scene_(scene), grid_(grid), pool_(pool) {
  std::vector<Facet> facets;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    if (!scene.objects[i].dynamic) add_facets(i, scene.objects[i].transform, facets);
  }
  still_ = touched(facets);
}

void Voxeliser::add_facets(std::uint32_t object, const ddgi::Affine& transform,
                           std::vector<Facet>& out) const {
  for (const std::uint32_t number : scene_.objects[object].meshes) {
    const ddgi::Mesh& mesh = scene_.meshes[number];
    const bool two_sided = scene_.materials[mesh.material].two_sided;
    for (const auto& corners : mesh.triangles) {
      Facet& facet = out.emplace_back();
      for (std::size_t i = 0; i < corners.size(); ++i) {
        facet.corners[i] = transform.point(mesh.positions[corners[i]]);
        // Those between them face no direction that none of them does.
        const Vec3 normal = normalize(transform.normal(mesh.normals[corners[i]]));
        facet.faced |= faced_by(normal);
        if (two_sided) facet.faced |= faced_by(-normal);
      }
    }
  }
}

std::vector<SurfaceVoxel> Voxeliser::touched(std::span<const Facet> facets) const {
  const double size = grid_.size;
  const Vec3 end = grid_.origin + Vec3{static_cast<float>(grid_.cells[0] * size),
                                       static_cast<float>(grid_.cells[1] * size),
                                       static_cast<float>(grid_.cells[2] * size)};
  double wanted = 0;
  for (const auto& [t, faced] : facets) {
    const Vec3 lo = max(min(min(t[0], t[1]), t[2]), grid_.origin);
    const Vec3 hi = min(max(max(t[0], t[1]), t[2]), end);
    if (!(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z)) continue;
    // No more than in the part of its box that is within the grid: ground may go on for ever.
    const Vec3 d = hi - lo;
    const double sides = double{d.x} * d.y + double{d.y} * d.z + double{d.z} * d.x;
    wanted += std::min(area(t), sides) / (size * size);
  }
  if (!(wanted <= kMaxTouched)) too_many(grid_.size);
  std::vector<std::vector<SurfaceVoxel>> parts((facets.size() + kBatch - 1) / kBatch);
  pool_.run(parts.size(), [&](std::size_t part) {
    Descent descent(grid_, parts[part]);
    const std::size_t end_of_part = std::min(facets.size(), (part + 1) * kBatch);
    for (std::size_t i = part * kBatch; i < end_of_part; ++i) {
      descent.add(facets[i].corners, facets[i].faced);
    }
    std::ranges::sort(parts[part]);
    unite(parts[part]);
  });
  std::vector<SurfaceVoxel> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  std::ranges::sort(all);
  unite(all);
  return all;
}

std::vector<SurfaceVoxel> Voxeliser::voxels(const ddgi::FrameState& state) const {
  std::vector<Facet> facets;
  for (std::uint32_t i = 0; i < scene_.objects.size(); ++i) {
    if (scene_.objects[i].dynamic) add_facets(i, state.transforms[i], facets);
  }
  const std::vector<SurfaceVoxel> moving = touched(facets);
  std::vector<SurfaceVoxel> all;
  all.reserve(still_.size() + moving.size());
  std::ranges::merge(still_, moving, std::back_inserter(all));
  unite(all);
  return all;
}

}  // namespace gicodec::voxels
