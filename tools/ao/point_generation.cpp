#include "point_generation.h"

#include "ddgi/noise.h"
#include "kinds/tracing.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace gicodec::ao {
namespace {

using ddgi::Affine;
using ddgi::Mesh;
using ddgi::Vec2;
using ddgi::Vec3;
using kinds::coordinate;

constexpr float kAround = 1;  ///< metres around the scene's volume
/// Side of a cell in distances of elimination: about three points on a surface through it, so that
/// seven have room where two surfaces meet, and 2×2×2 cells reach 0.8 of the radius around a place.
constexpr float kCellSide = 1.6F;

/// A mesh in the world at rest, as much of it as gets points.
struct SampledMesh {
  const Mesh& mesh;
  Affine transform;
  const ddgi::Box* box;  ///< nullptr: all of it
  double scale;          ///< metres of the world per unit of the mesh
  bool two_sided;
  std::vector<double> areas{};  ///< of the triangles up to and including each, in the mesh's units
};

/// The part of a triangle within the box, by weights of its second and third corner.
std::vector<Vec2> part_inside(const SampledMesh& sampled, std::size_t triangle) {
  std::vector<Vec2> part{{0, 0}, {1, 0}, {0, 1}};
  if (sampled.box == nullptr) return part;
  const auto [a, b, c] = sampled.mesh.triangles[triangle];
  const auto& p = sampled.mesh.positions;
  const auto corner = [&](std::uint32_t i) { return sampled.transform.point(p[i]); };
  const Vec3 origin = corner(a), u = corner(b) - origin, v = corner(c) - origin;
  for (unsigned plane = 0; plane < 6; ++plane) {
    const unsigned axis = plane / 2;
    const bool upper = plane % 2 == 1;
    const float limit = coordinate(upper ? sampled.box->hi : sampled.box->lo, axis);
    const auto depth = [&](Vec2 w) {
      const float at =
          coordinate(origin, axis) + w.x * coordinate(u, axis) + w.y * coordinate(v, axis);
      return upper ? limit - at : at - limit;
    };
    std::vector<Vec2> kept;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Vec2 from = part[i], to = part[(i + 1) % part.size()];
      const float d0 = depth(from), d1 = depth(to), share = d0 / (d0 - d1);
      if (d0 >= 0) kept.push_back(from);
      if ((d0 < 0) != (d1 < 0)) {
        kept.push_back({ddgi::mix(from.x, to.x, share), ddgi::mix(from.y, to.y, share)});
      }
    }
    part = std::move(kept);
  }
  return part;
}

/// Of the triangle between the corners 0, i + 1 and i + 2 of a part; the whole triangle's is 1.
double share_of(const std::vector<Vec2>& part, std::size_t i) {
  const Vec2 a = part[0], b = part[i + 1], c = part[i + 2];
  return std::abs(double{b.x - a.x} * (c.y - a.y) - double{c.x - a.x} * (b.y - a.y));
}

Vec3 doubled_area(const Mesh& mesh, std::size_t triangle) {
  const auto [a, b, c] = mesh.triangles[triangle];
  const auto& p = mesh.positions;
  return cross(p[b] - p[a], p[c] - p[a]);
}

void add_areas(SampledMesh& sampled) {
  double sum = 0;
  for (std::size_t i = 0; i < sampled.mesh.triangles.size(); ++i) {
    const auto part = part_inside(sampled, i);
    double share = 0;
    for (std::size_t j = 0; j + 2 < part.size(); ++j) share += share_of(part, j);
    sum += share * double{length(doubled_area(sampled.mesh, i))} / 2;
    sampled.areas.push_back(sum);
  }
}

SurfacePoint sample(const SampledMesh& sampled, std::uint32_t seed, std::uint32_t number,
                    bool other_side) {
  const auto random = [&](std::uint32_t dimension) {
    return ddgi::unit(ddgi::hash(ddgi::hash(seed, dimension), number));
  };
  // Two numbers, since one has but 24 bits for what may be millions of triangles.
  const double at = (double{random(0)} + double{random(1)} / (1 << 24)) * sampled.areas.back();
  const auto found = std::ranges::upper_bound(sampled.areas, at) - sampled.areas.begin();
  const auto triangle = std::min(static_cast<std::size_t>(found), sampled.areas.size() - 1);
  const auto part = part_inside(sampled, triangle);
  double all = 0;
  for (std::size_t i = 0; i + 2 < part.size(); ++i) all += share_of(part, i);
  std::size_t piece = 0;
  for (double left = all * random(2); piece + 3 < part.size(); ++piece) {
    left -= share_of(part, piece);
    if (left < 0) break;
  }
  const Mesh& mesh = sampled.mesh;
  const std::array<std::uint32_t, 3> corners = mesh.triangles[triangle];
  Vec2 w;
  if (part.size() >= 3) {
    const float root = std::sqrt(random(3)), v = random(4) * root, u = root - v;
    const Vec2 p = part[0], q = part[piece + 1], r = part[piece + 2];
    w = {p.x + u * (q.x - p.x) + v * (r.x - p.x), p.y + u * (q.y - p.y) + v * (r.y - p.y)};
  }
  const auto blend = [&](const std::vector<Vec3>& of) {
    return of[corners[0]] * (1 - w.x - w.y) + of[corners[1]] * w.x + of[corners[2]] * w.y;
  };
  SurfacePoint point{blend(mesh.positions), normalize(blend(mesh.normals)),
                     normalize(doubled_area(mesh, triangle))};
  if (!(length(point.normal) > 0)) point.normal = point.geometric;
  if (other_side) point.normal = -point.normal, point.geometric = -point.geometric;
  return point;
}

AoGrid grid_of(const PointInstance& instance, float distance, double area, float margin) {
  ddgi::Box box = instance.box();
  box.lo = box.lo - Vec3{margin, margin, margin}, box.hi = box.hi + Vec3{margin, margin, margin};
  const Vec3 size = box.size();
  AoGrid grid;
  grid.object = instance.object, grid.mesh = instance.mesh;
  grid.radius = distance;
  // One cell less than there may be: what lies on the far side of the box is in a cell as well.
  grid.cell =
      std::max(kCellSide * distance, std::max({size.x, size.y, size.z}) / (kMaxAoGridSide - 2));
  const auto cells = [&](float side) { return static_cast<std::uint32_t>(side / grid.cell) + 1; };
  grid.origin = {box.lo.x, box.lo.y, box.lo.z};
  grid.cells = {cells(size.x), cells(size.y), cells(size.z)};
  const double average = area / (double{grid.cell} * grid.cell);
  grid.buckets = static_cast<std::uint32_t>(std::ceil(4 * average / kAoBucketEntries));
  grid.buckets = std::max(grid.buckets, 1U);
  return grid;
}

void fill(PointInstance& instance, const SampledMesh& sampled, const GenerationOptions& options,
          double points, ddgi::ThreadPool& pool) {
  const double area = sampled.areas.back(), density = points * sampled.scale * sampled.scale;
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): not negative
  const auto kept = std::max(std::size_t{1}, static_cast<std::size_t>(area * density / 2 + 0.5));
  const std::size_t sides = sampled.two_sided ? 2 : 1;
  std::vector<SurfacePoint> samples(2 * kept * sides);
  const std::uint32_t seed = ddgi::hash(ddgi::hash(options.seed, instance.object), instance.mesh);
  kinds::for_all(samples.size(), pool, [&](std::size_t i) {
    samples[i] = sample(sampled, seed, static_cast<std::uint32_t>(i), i >= 2 * kept);
  });
  const float r_max = largest_radius(area, static_cast<double>(kept));
  for (const std::uint32_t i : eliminate(samples, kept * sides, r_max, pool)) {
    instance.points.push_back(samples[i]);
  }
  instance.grid =
      grid_of(instance, 2 * r_max, area, options.margin / static_cast<float>(sampled.scale));
}

}  // namespace

ddgi::Box PointInstance::box() const {
  ddgi::Box box;
  for (const SurfacePoint& point : points) box.add(point.position);
  return box;
}

GeneratedPoints generate_points(const ddgi::Scene& scene, const GenerationOptions& options,
                                ddgi::ThreadPool& pool) {
  GeneratedPoints out{{}, options.points, {}};
  const Vec3 around{kAround, kAround, kAround};
  const ddgi::Box box{scene.volume.lo - around, scene.volume.hi + around};
  std::vector<SampledMesh> sampled_meshes;
  double square_metres = 0;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    const ddgi::Object& object = scene.objects[o];
    const bool clipped = !options.outside && !object.dynamic && !scene.volume.empty();
    for (const std::uint32_t m : object.meshes) {
      const Mesh& mesh = scene.meshes[m];
      SampledMesh sampled{mesh, object.transform, clipped ? &box : nullptr,
                          std::cbrt(std::abs(double{object.transform.determinant()})),
                          scene.materials[mesh.material].two_sided};
      add_areas(sampled);
      const double area = sampled.areas.empty() ? 0 : sampled.areas.back();
      if (!(area > 0) || !std::isfinite(area) || !(sampled.scale > 0)) continue;
      square_metres += area * sampled.scale * sampled.scale * (sampled.two_sided ? 2 : 1);
      out.instances.emplace_back().object = o;
      out.instances.back().mesh = m;
      sampled_meshes.push_back(std::move(sampled));
    }
  }
  const auto most = static_cast<double>(options.max_points);
  if (square_metres * out.points / 2 > most) {
    out.points = 2 * most / square_metres;
    out.remarks.push_back(
        fmt::format("{:.1f} points per square metre instead of {:g}, so that no more than {} stay "
                    "of {:.0f} m²; --set max-points=N allows others",
                    out.points, options.points, options.max_points, square_metres));
  }
  for (std::size_t i = 0; i < sampled_meshes.size(); ++i) {
    fill(out.instances[i], sampled_meshes[i], options, out.points, pool);
  }
  return out;
}

}  // namespace gicodec::ao
