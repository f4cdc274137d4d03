#include "parameterisation.h"

#include "dump/error.h"

#include <algorithm>
#include <cmath>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace gicodec::maps {
namespace {

/// The same packing everywhere: qsort() may exchange equals.
template <typename Rect, typename Compare>
void sort_rects(Rect* rects, int count, Compare compare) {
  std::stable_sort(rects, rects + count,
                   [compare](const Rect& a, const Rect& b) { return compare(&a, &b) < 0; });
}

}  // namespace
}  // namespace gicodec::maps

#define STBRP_SORT(rects, count, size, compare) gicodec::maps::sort_rects(rects, count, compare)
#define STBRP_STATIC
#define STB_RECT_PACK_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_rect_pack.h>
#pragma GCC diagnostic pop

namespace gicodec::maps {
namespace {

using namespace ddgi;

constexpr int kSteps = 18;        // of the search for the density
constexpr double kFlat = 0.75;    // texels below which an extent counts as none
constexpr double kLimit = 65536;  // texels of a side, before anything is packed

/// Texels along an extent, so that bilinear look-ups within it need no other.
std::uint32_t texels_along(double extent) {
  return extent < kFlat ? 1 : static_cast<std::uint32_t>(std::ceil(std::min(extent, kLimit))) + 1;
}

float cross2(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
Vec2 minus(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
float dot2(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }

/// Whether a bilinear look-up somewhere in the triangle reads the texel at `c`: whether it meets
/// the open square of half side 1 around it.
bool is_read(Vec2 c, const std::array<Vec2, 3>& t) {
  const auto [lx, hx] = std::minmax({t[0].x, t[1].x, t[2].x});
  const auto [ly, hy] = std::minmax({t[0].y, t[1].y, t[2].y});
  if (lx >= c.x + 1 || hx <= c.x - 1 || ly >= c.y + 1 || hy <= c.y - 1) return false;
  const float side = cross2(minus(t[1], t[0]), minus(t[2], t[0])) < 0 ? -1.0F : 1.0F;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 edge = minus(t[(i + 1) % 3], t[i]);
    const float reach = std::abs(edge.x) + std::abs(edge.y);
    if (side * cross2(edge, minus(c, t[i])) <= -reach && reach > 0) return false;
  }
  return true;
}

struct Nearest {
  float squared = 1e30F, u = 0, v = 0;
};

/// The point of the triangle that is nearest to `c`.
Nearest nearest(Vec2 c, const std::array<Vec2, 3>& t) {
  const Vec2 e1 = minus(t[1], t[0]), e2 = minus(t[2], t[0]), d = minus(c, t[0]);
  const float area = cross2(e1, e2);
  if (area != 0) {
    const float u = cross2(d, e2) / area, v = cross2(e1, d) / area;
    if (u >= 0 && v >= 0 && u + v <= 1) return {0, u, v};
  }
  Nearest best;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 a = t[i], edge = minus(t[(i + 1) % 3], a), to = minus(c, a);
    const float squared = dot2(edge, edge);
    const float s = squared > 0 ? saturate(dot2(to, edge) / squared) : 0;
    const Vec2 rest{to.x - edge.x * s, to.y - edge.y * s};
    const float far = dot2(rest, rest);
    if (!(far < best.squared)) continue;
    best.squared = far;
    best.u = i == 0 ? s : i == 1 ? 1 - s : 0;
    best.v = i == 0 ? 0 : i == 1 ? s : 1 - s;
  }
  return best;
}

}  // namespace

Parameterisation::Parameterisation(const Scene& scene, std::uint32_t width, std::uint32_t height)
    : charts_(make_charts(scene)), width_(width), height_(height) {
  std::uint32_t instance = 0;
  for (const Object& object : scene.objects) {
    first_instance_.push_back(instance);
    instance += static_cast<std::uint32_t>(object.meshes.size());
  }
  first_instance_.push_back(instance);
  double area = 1e-12;
  for (const Chart& chart : charts_.charts) {
    area += double{chart.size.x} * chart.size.y * chart.density * chart.density;
  }
  // The densest that fits, by bisection; where nothing fits at 0, charts are too many.
  double lo = 0, hi = 2 * std::sqrt(1.0 * width_ * height_ / area);
  for (int step = 0; step < kSteps; ++step) {
    const double middle = (lo + hi) / 2;
    (pack(middle) ? lo : hi) = middle;
  }
  if (!pack(lo)) {
    tools::fail(tools::Exit::usage,
                "{}: {} charts do not fit into {}x{} texels; choose a larger size", scene.name,
                charts_.charts.size(), width_, height_);
  }
  density_ = static_cast<float>(lo);
  place_corners();
  find_texels();
  make_hash();
}

bool Parameterisation::pack(double density) {
  std::vector<stbrp_rect> rects;
  double sum = 0;
  for (const Chart& chart : charts_.charts) {
    const double scale = density * chart.density;
    stbrp_rect rect{};
    rect.id = static_cast<int>(rects.size());
    rect.w = static_cast<int>(texels_along(chart.size.x * scale));
    rect.h = static_cast<int>(texels_along(chart.size.y * scale));
    if (rect.w > static_cast<int>(width_) || rect.h > static_cast<int>(height_)) return false;
    sum += 1.0 * rect.w * rect.h;
    rects.push_back(rect);
  }
  if (sum > 1.0 * width_ * height_) return false;
  stbrp_context context;
  std::vector<stbrp_node> nodes(width_);
  stbrp_init_target(&context, static_cast<int>(width_), static_cast<int>(height_), nodes.data(),
                    static_cast<int>(nodes.size()));
  if (stbrp_pack_rects(&context, rects.data(), static_cast<int>(rects.size())) == 0) return false;
  rects_.clear();
  for (const stbrp_rect& rect : rects) {
    rects_.push_back({static_cast<std::uint32_t>(rect.x), static_cast<std::uint32_t>(rect.y),
                      static_cast<std::uint32_t>(rect.w), static_cast<std::uint32_t>(rect.h)});
  }
  return true;
}

void Parameterisation::place_corners() {
  corners_.assign(charts_.positions.size(), {});
  for (std::size_t c = 0; c < charts_.charts.size(); ++c) {
    const Chart& chart = charts_.charts[c];
    const ChartRect& rect = rects_[c];
    const float scale = density_ * chart.density;
    const auto along = [scale](float at, float size, std::uint32_t texels) {
      const auto most = static_cast<float>(texels - 1);
      // In this order no coordinate is a NaN.
      return std::max(0.0F, std::min(most, (most - size * scale) / 2 + at * scale));
    };
    for (const std::uint32_t triangle : chart.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 p = charts_.positions[triangle][i];
        corners_[triangle][i] = {static_cast<float>(rect.x) + along(dot(p, chart.u) - chart.least.x,
                                                                    chart.size.x, rect.width),
                                 static_cast<float>(rect.y) + along(dot(p, chart.v) - chart.least.y,
                                                                    chart.size.y, rect.height)};
      }
    }
  }
}

void Parameterisation::find_texels() {
  std::vector<MapTexel> best(std::size_t{width_} * height_);
  std::vector<float> far(best.size(), 1e30F);
  for (std::uint32_t c = 0; c < charts_.charts.size(); ++c) find_texels_of(c, best, far);
  for (std::size_t place = 0; place < best.size(); ++place) {
    if (far[place] < 1e30F) texels_.push_back(best[place]);
  }
}

void Parameterisation::find_texels_of(std::uint32_t chart, std::vector<MapTexel>& best,
                                      std::vector<float>& far) {
  const ChartRect& rect = rects_[chart];
  const auto range = [](float lo, float hi, std::uint32_t first, std::uint32_t count) {
    const auto from = static_cast<std::uint32_t>(std::max(std::floor(lo), 0.0F));
    const auto to = static_cast<std::uint32_t>(std::max(std::ceil(hi), 0.0F));
    return std::pair(std::max(from, first), std::min(to, first + count - 1));
  };
  for (const std::uint32_t triangle : charts_.charts[chart].triangles) {
    const std::array<Vec2, 3>& t = corners_[triangle];
    const auto [lx, hx] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [ly, hy] = std::minmax({t[0].y, t[1].y, t[2].y});
    const auto [x0, x1] = range(lx, hx, rect.x, rect.width);
    const auto [y0, y1] = range(ly, hy, rect.y, rect.height);
    for (std::uint32_t y = y0; y <= y1; ++y) {
      for (std::uint32_t x = x0; x <= x1; ++x) {
        const Vec2 centre{static_cast<float>(x), static_cast<float>(y)};
        if (!is_read(centre, t)) continue;
        const std::size_t place = x + std::size_t{width_} * y;
        const Nearest near = nearest(centre, t);
        if (!(near.squared < far[place])) continue;
        far[place] = near.squared;
        best[place] = {static_cast<std::uint32_t>(place), triangle, near.u, near.v};
      }
    }
  }
}

void Parameterisation::make_hash() {
  const std::uint32_t size[2] = {width_, height_};
  hash_ = XXH3_64bits(size, sizeof size);
  hash_ = XXH3_64bits_withSeed(corners_.data(), corners_.size() * sizeof corners_[0], hash_);
  hash_ = XXH3_64bits_withSeed(texels_.data(), texels_.size() * sizeof(MapTexel), hash_);
  hash_ = XXH3_64bits_withSeed(charts_.chart_of.data(), charts_.chart_of.size() * 4, hash_);
}

const Instance& Parameterisation::instance_of(std::uint32_t triangle) const {
  const auto after = std::upper_bound(
      charts_.instances.begin(), charts_.instances.end(), triangle,
      [](std::uint32_t t, const Instance& i) { return t < i.first + i.triangles; });
  return *after;
}

std::vector<std::array<Vec2, 3>> Parameterisation::texture_coordinates(
    const Instance& instance) const {
  const auto all = std::span(corners_).subspan(instance.first, instance.triangles);
  std::vector<std::array<Vec2, 3>> out(all.begin(), all.end());
  for (auto& triangle : out) {
    for (Vec2& p : triangle) {
      p = {(p.x + 0.5F) / static_cast<float>(width_), (p.y + 0.5F) / static_cast<float>(height_)};
    }
  }
  return out;
}

Parameterisation::Taps Parameterisation::taps(const Surface& surface) const {
  Taps taps;
  if (surface.object + 1 >= first_instance_.size()) return taps;
  for (std::uint32_t i = first_instance_[surface.object]; i < first_instance_[surface.object + 1];
       ++i) {
    const Instance& instance = charts_.instances[i];
    if (instance.mesh != surface.mesh || surface.triangle >= instance.triangles) continue;
    const std::uint32_t triangle = instance.first + surface.triangle;
    if (charts_.chart_of[triangle] == SceneCharts::kNone) return taps;
    const auto& [a, b, c] = corners_[triangle];
    float u = std::max(surface.u, 0.0F), v = std::max(surface.v, 0.0F);
    if (!(u + v <= 1)) {  // rays meet triangles a little beyond their edges
      const float sum = u + v;
      u = std::isfinite(sum) ? u / sum : 0;
      v = std::isfinite(sum) ? v / sum : 0;
    }
    const ChartRect& rect = rects_[charts_.chart_of[triangle]];
    const auto split = [](float at, std::uint32_t first, std::uint32_t count) {
      const float from =
          std::clamp(at - static_cast<float>(first), 0.0F, static_cast<float>(count - 1));
      const auto texel = std::min(static_cast<std::uint32_t>(from), count > 1 ? count - 2 : 0);
      return std::pair(texel, from - static_cast<float>(texel));
    };
    const auto [x, fx] = split(a.x + (b.x - a.x) * u + (c.x - a.x) * v, rect.x, rect.width);
    const auto [y, fy] = split(a.y + (b.y - a.y) * u + (c.y - a.y) * v, rect.y, rect.height);
    for (std::uint32_t tap = 0; tap < 4; ++tap) {
      const std::uint32_t right = tap & 1, down = tap >> 1;
      const float weight = (right != 0 ? fx : 1 - fx) * (down != 0 ? fy : 1 - fy);
      if (!(weight > 0)) continue;
      taps.place[tap] = rect.x + x + right + width_ * (rect.y + y + down);
      taps.weight[tap] = weight;
    }
    return taps;
  }
  return taps;
}

}  // namespace gicodec::maps
