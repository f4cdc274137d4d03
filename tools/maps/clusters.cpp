#include "clusters.h"

#include "blend_slots.h"

#include "ddgi/noise.h"
#include "dump/error.h"
#include "kinds/tracing.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace gicodec::maps {

using namespace ddgi;

namespace {

constexpr std::uint32_t kBlockSide = kMapBaseBlock;
constexpr std::uint32_t kBlock = kBlockSide * kBlockSide;
constexpr int kTries = 6;             // of spacings
constexpr std::uint32_t kCurve = 14;  // bits of a coordinate, as many as the largest map has

/// Position along Hilbert's curve through a square of side 2^bits.
std::uint32_t hilbert(std::uint32_t bits, std::uint32_t x, std::uint32_t y) {
  std::uint32_t d = 0;
  for (std::uint32_t s = 1U << (bits - 1); s > 0; s >>= 1) {
    const std::uint32_t rx = (x & s) != 0 ? 1 : 0, ry = (y & s) != 0 ? 1 : 0;
    d += s * s * ((3 * rx) ^ ry);
    if (ry == 0) {
      if (rx == 1) {
        x = ~x & (2 * s - 1), y = ~y & (2 * s - 1);
      }
      std::swap(x, y);
    }
    x &= s - 1, y &= s - 1;
  }
  return d;
}

/// Bases by cells of the world.
class Grid {
 public:
  explicit Grid(float cell) : cell_(cell) {}
  void add(Vec3 p, std::uint32_t group, std::uint32_t basis) {
    cells_[key(index(p.x), index(p.y), index(p.z), group)].push_back(basis);
  }
  /// Until `visit` answers true; whether it did.
  template <typename Visit>
  bool any_near(Vec3 p, std::uint32_t group, const Visit& visit) const {
    for (std::int32_t i = 0; i < 27; ++i) {
      const auto found = cells_.find(
          key(index(p.x) + i % 3 - 1, index(p.y) + i / 3 % 3 - 1, index(p.z) + i / 9 - 1, group));
      if (found == cells_.end()) continue;
      for (const std::uint32_t basis : found->second) {
        if (visit(basis)) return true;
      }
    }
    return false;
  }

 private:
  [[nodiscard]] std::int32_t index(float at) const {
    return static_cast<std::int32_t>(std::floor(std::clamp(at / cell_, -1e9F, 1e9F)));
  }
  static std::uint64_t key(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t group) {
    const auto part = [](std::int32_t v) { return static_cast<std::uint64_t>(v) & 0x3FFFFU; };
    return part(x) | part(y) << 18 | part(z) << 36 | std::uint64_t{group & 0x3FFU} << 54;
  }
  float cell_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

class Clusterer {
 public:
  Clusterer(const Parameterisation& map, const RayScene& scene, std::span<const MapTexel> texels,
            ThreadPool& pool)
      : map_(map), scene_(scene), texels_(texels), pool_(pool), sites_(texels.size()) {
    kinds::for_all(sites_.size(), pool_, [&](std::size_t i) {
      const MapTexel& texel = texels_[i];
      const std::uint32_t object = map_.instance_of(texel.triangle).object;
      const float density = map_.scene().charts[map_.scene().chart_of[texel.triangle]].density;
      const bool moves = scene_.scene().objects[object].dynamic;
      sites_[i] = {point_of(map_, scene_, texel), 1 / density,
                   2 * (moves ? object + 1 : 0) + (density < 1 ? 1U : 0U)};
    });
  }

  Bases run(std::uint32_t target, float spacing) {
    const float side = std::sqrt(static_cast<float>(sites_.size())) / map_.density();
    spacing_ = spacing > 0 ? spacing : side * std::sqrt(0.7F / static_cast<float>(target));
    const float far = std::max(spacing_, length(scene_.scene().bounds().size()));
    for (int i = 0; i < kTries; ++i) {
      choose();
      const float ratio = static_cast<float>(bases_.size()) / static_cast<float>(target);
      if (spacing > 0 || i + 1 == kTries || std::abs(ratio - 1) < 0.01F) break;
      // Where surfaces are many, more distance helps no more.
      spacing_ = std::min(spacing_ * std::sqrt(ratio), far);
    }
    if (bases_.size() > kMaxMapBases) {
      tools::fail(tools::Exit::usage,
                  "a spacing of {:g} m gives {} bases, of which there can be {}; choose a larger "
                  "spacing, or fewer bases",
                  spacing_, bases_.size(), kMaxMapBases);
    }
    sort();
    Bases out;
    out.spacing = spacing_;
    out.blends.resize(sites_.size());
    assign(out.blends);
    align_slots(texels_, map_.width(), out.blends);
    for (const std::uint32_t site : bases_) out.centres.push_back(texels_[site]);
    out.rays = rays_;
    return out;
  }

 private:
  struct Site {
    MapPoint point;
    float scale = 1;          ///< of spacings around it
    std::uint32_t group = 0;  ///< of sites that may share bases
  };

  /// From a little above one surface to a little above the other, over what bulges between them.
  [[nodiscard]] bool sees(const Site& a, const Site& b) const {
    const float far = length(b.point.position - a.point.position);
    const float lift = 0.005F + 0.1F * std::min(far, 2.0F);
    const Vec3 from = a.point.position + a.point.geometric_normal * lift;
    const Vec3 way = b.point.position + b.point.geometric_normal * lift - from;
    const float distance = length(way);
    if (distance < 1e-4F) return true;
    rays_.fetch_add(1, std::memory_order_relaxed);
    return !scene_.occluded(from, way / distance, distance * 0.999F);
  }

  /// How much a basis matters to a site; 0 beyond its radius and for other directions.
  [[nodiscard]] float weight(const Site& a, const Site& basis) const {
    const Vec3 way = basis.point.position - a.point.position;
    const float radius = 2 * spacing_ * a.scale, near = 1 - dot(way, way) / (radius * radius);
    const float like = dot(a.point.normal, basis.point.normal);
    if (a.group != basis.group || !(near > 0) || !(like >= kLikeBasis)) return 0;
    return near * near * (0.05F + 0.95F * (like - kLikeBasis) / (1 - kLikeBasis));
  }

  [[nodiscard]] bool covers(const Site& a, const Site& basis) const {
    const Vec3 way = basis.point.position - a.point.position;
    const float least = spacing_ * a.scale;
    return dot(way, way) < least * least && weight(a, basis) > 0 && sees(a, basis);
  }

  Grid grid_of(float cell) const {
    Grid grid(cell);
    for (std::uint32_t b = 0; b < bases_.size(); ++b) {
      const Site& site = sites_[bases_[b]];
      grid.add(site.point.position / site.scale, site.group, b);
    }
    return grid;
  }

  /// Darts in a scattered order: a texel becomes a basis unless another one covers it.
  void choose() {
    std::vector<std::uint32_t> order(sites_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [](std::uint32_t a, std::uint32_t b) {
      return std::pair(hash(a), a) < std::pair(hash(b), b);
    });
    bases_.clear();
    Grid grid(spacing_);
    for (std::size_t n = 0; n < order.size(); ++n) {
      if (n % 1024 == 0) pool_.check();
      const std::uint32_t i = order[n];
      const Site& site = sites_[i];
      const Vec3 at = site.point.position / site.scale;
      const bool covered = grid.any_near(
          at, site.group, [&](std::uint32_t b) { return covers(site, sites_[bases_[b]]); });
      if (covered) continue;
      grid.add(at, site.group, static_cast<std::uint32_t>(bases_.size()));
      bases_.push_back(i);
    }
  }

  /// Charts that are near each other follow each other, in each of them its bases along a curve;
  /// and so do those of a block.
  void sort() {
    const SceneCharts& scene = map_.scene();
    const ddgi::Box box = scene_.scene().bounds();
    const Vec3 size = max(box.size(), {1e-6F, 1e-6F, 1e-6F});
    const auto chart_key = [&](std::uint32_t chart) {
      const Vec3 p = scene.positions[scene.charts[chart].triangles.front()][0] - box.lo;
      const auto cell = [](float at, float of) {
        return static_cast<std::uint32_t>(saturate(at / of) * 63);
      };
      const std::uint32_t x = cell(p.x, size.x), y = cell(p.y, size.y), z = cell(p.z, size.z);
      return hilbert(6, x, z) << 6 | y;
    };
    using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>;
    std::vector<std::pair<Key, std::uint32_t>> keys;
    for (const std::uint32_t site : bases_) {
      const MapTexel& texel = texels_[site];
      const std::uint32_t chart = scene.chart_of[texel.triangle];
      const ChartRect& rect = map_.rects()[chart];
      const std::uint32_t along =
          hilbert(kCurve, texel.place % map_.width() - rect.x, texel.place / map_.width() - rect.y);
      keys.push_back({{chart_key(chart), chart, along, texel.place}, site});
    }
    std::sort(keys.begin(), keys.end());
    std::array<std::uint32_t, kBlock> place{};
    for (std::uint32_t i = 0; i < kBlock; ++i)
      place[hilbert(3, i % kBlockSide, i / kBlockSide)] = i;
    const std::size_t whole = keys.size() / kBlock * kBlock;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const std::size_t at = i < whole ? i / kBlock * kBlock + place[i % kBlock] : i;
      bases_[at] = keys[i].second;
    }
  }

  void assign(std::vector<Blend>& blends) {
    const Grid grid = grid_of(2 * spacing_);
    kinds::for_all(sites_.size(), pool_, [&](std::size_t i) {
      const Site& site = sites_[i];
      std::vector<std::pair<float, std::uint32_t>> near;
      grid.any_near(site.point.position / site.scale, site.group, [&](std::uint32_t b) {
        const float w = weight(site, sites_[bases_[b]]);
        if (w > 0) near.emplace_back(-w, b);
        return false;
      });
      std::sort(near.begin(), near.end());
      std::size_t kept = 0;
      for (std::size_t n = 0; n < near.size() && kept < kMapBlends; ++n) {
        if (sees(site, sites_[bases_[near[n].second]])) near[kept++] = near[n];
      }
      near.resize(kept);
      blends[i] = rounded(near);
    });
  }

  /// To parts of 255, what rounding takes going to the heaviest; by number of the basis.
  static Blend rounded(std::vector<std::pair<float, std::uint32_t>>& near) {
    Blend out;
    if (near.empty()) return out;  // cannot be: a texel that nothing covers is a basis
    float sum = 0;
    for (const auto& [w, b] : near) sum -= w;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> parts;
    std::uint32_t left = 255;
    for (const auto& [w, b] : near) {
      const auto part = static_cast<std::uint32_t>(std::floor(-w / sum * 255));
      if (part > 0 && part <= left) parts.emplace_back(b, part), left -= part;
    }
    parts.front().second += left;
    std::sort(parts.begin(), parts.end());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      out.basis[i] = static_cast<std::uint16_t>(parts[i].first);
      out.weight[i] = static_cast<std::uint8_t>(parts[i].second);
    }
    return out;
  }

  const Parameterisation& map_;
  const RayScene& scene_;
  std::span<const MapTexel> texels_;
  ThreadPool& pool_;
  std::vector<Site> sites_;           ///< by number of the texel
  std::vector<std::uint32_t> bases_;  ///< their sites
  float spacing_ = 1;
  mutable std::atomic<std::uint64_t> rays_{0};
};

}  // namespace

Bases make_bases(const Parameterisation& map, const RayScene& scene,
                 std::span<const MapTexel> texels, std::uint32_t target, float spacing,
                 ThreadPool& pool) {
  return Clusterer(map, scene, texels, pool).run(target, spacing);
}

void reconstruct(std::span<const MapTexel> texels, std::span<const Blend> blends,
                 std::span<const Vec3> bases, std::span<Vec3> out) {
  for (std::size_t i = 0; i < blends.size(); ++i) {
    Vec3 sum;
    for (std::size_t k = 0; k < kMapBlends; ++k) {
      const Blend& blend = blends[i];
      if (blend.weight[k] == 0 || blend.basis[k] >= bases.size()) continue;
      sum += bases[blend.basis[k]] * (static_cast<float>(blend.weight[k]) / 255.0F);
    }
    out[texels[i].place] = sum;
  }
}

}  // namespace gicodec::maps
