#include "framing.h"

#include "lighting.h"
#include "rays.h"

#include <array>

namespace gicodec::ddgi {
namespace {

constexpr std::uint32_t kRays = 256;
constexpr float kFlat = 0.01F;    // of the greatest extent
constexpr float kInside = 0.25F;  // share of rays that meet surfaces from behind
constexpr float kFov = 60;

float greatest(Vec3 v) { return std::max({v.x, v.y, v.z}); }

/// What a ray brings to a view: much where it meets lit surfaces, little where it meets dark ones
/// or the sky, nothing where it meets a surface from behind.
struct Sample {
  Vec3 direction;
  float value = 0;
  bool back = false, front = false, lit = false;
};

std::vector<Sample> look_around(const RayScene& scene, Vec3 eye, float near) {
  std::vector<Sample> samples;
  for (const Vec3 d : fibonacci_directions(kRays)) {
    Sample& s = samples.emplace_back(Sample{d});
    const auto hit = scene.intersect(eye, d, 0);
    if (!hit) {
      s.value = 0.05F;
      continue;
    }
    s.back = hit->back;
    s.front = !hit->back;
    if (hit->back) continue;
    std::uint64_t rays = 0;
    s.lit = greatest(hit->emission + hit->albedo * direct_light(scene, *hit, rays)) > 1e-3F;
    s.value = (s.lit ? 1 : 0.2F) * (hit->distance < near ? 0.3F : 1);
  }
  return samples;
}

bool inside(const std::vector<Sample>& samples) {
  const auto backs = std::count_if(samples.begin(), samples.end(), [](auto& s) { return s.back; });
  return static_cast<float>(backs) > kInside * kRays;
}

/// Points in the middles of n × n × n equal parts of a box.
std::vector<Vec3> points(const Box& box, int n) {
  std::vector<Vec3> out;
  for (int i = 0; i < n * n * n; ++i) {
    const int x = i % n, y = i / n % n, z = i / n / n;
    const Vec3 cell{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    out.push_back(box.lo +
                  (cell + Vec3{0.5F, 0.5F, 0.5F}) * (1 / static_cast<float>(n)) * box.size());
  }
  return out;
}

}  // namespace

Box inner_box(const Box& bounds) {
  const Vec3 size = bounds.size();
  const float most = greatest(size);
  const auto inset = [most](float extent) {
    return extent < kFlat * most ? 0.5F * (extent - most / 8) : 0.02F * extent;
  };
  const Vec3 by{inset(size.x), inset(size.y), inset(size.z)};
  return {bounds.lo + by, bounds.hi - by};
}

Box outer_box(const Box& bounds) {
  const float by = 0.25F * greatest(bounds.size());
  return {bounds.lo - Vec3{by, by, by}, bounds.hi + Vec3{by, by, by}};
}

Box find_volume(const RayScene& scene) {
  const Box bounds = scene.scene().bounds(), inner = inner_box(bounds);
  for (const Vec3 point : points(inner, 4)) {
    if (!inside(look_around(scene, point, 0))) return inner;
  }
  return outer_box(bounds);
}

std::optional<View> find_view(const RayScene& scene) {
  const Box bounds = scene.scene().bounds(), inner = inner_box(bounds);
  const Vec3 center = bounds.center();
  const float radius = 0.5F * length(inner.size());
  struct Eye {
    Vec3 position;
    bool outside;
  };
  std::vector<Eye> eyes;
  for (const Vec3 point : points(inner, 3)) eyes.push_back({point, false});
  std::array<Vec3, 8> headings;
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const float angle = 2 * kPi * (static_cast<float>(i) + 0.5F) / headings.size();
    headings[i] = {std::sin(angle), 0, -std::cos(angle)};
    const Vec3 back = normalize(Vec3{0, 0.5F, 0} - headings[i]);
    eyes.push_back({center + back * (radius / std::sin(radians(kFov / 2))), true});
  }

  float best = 0;
  std::optional<View> view;
  for (const Eye& eye : eyes) {
    const auto samples = look_around(scene, eye.position, 0.1F * radius);
    if (inside(samples)) continue;
    for (const Vec3 heading : headings) {
      const Vec3 forward =
          normalize(eye.outside ? center - eye.position : heading + Vec3{0, -0.2F, 0});
      float sum = 0, count = 0;
      bool front = false, lit = false;
      for (const Sample& s : samples) {
        if (dot(s.direction, forward) < std::cos(radians(40))) continue;
        sum += s.value, ++count;
        front = front || s.front;
        lit = lit || s.lit;
      }
      if (front && sum > best * count) {
        best = sum / count;
        view = View{{.eye = eye.position, .target = eye.position + forward, .fov_y = kFov}, lit};
      }
      if (eye.outside) break;  // these look at the scene only
    }
  }
  return view;
}

}  // namespace gicodec::ddgi
