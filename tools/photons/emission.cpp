#include "emission.h"

#include "ddgi/noise.h"
#include "kinds/tracing.h"

namespace gicodec::photons {
namespace {

using ddgi::kPi;
using ddgi::Light;
using ddgi::LightType;
using ddgi::Vec3;
using kinds::around;

/// Solid angle over 2π of a spot's cone that is as bright as its middle, and of its soft edge,
/// which counts as half of that.
struct Cone {
  float full, edge;
  explicit Cone(const Light& light)
      : full(1 - light.cos_inner), edge(std::max(0.0F, light.cos_inner - light.cos_outer) / 2) {}
};

/// Where the integral of smoothstep from 0 on, t³ − t⁴/2, has grown to a share of its whole.
float inverse_edge(float share) {
  float lo = 0, hi = 1;
  for (int i = 0; i < 24; ++i) {
    const float t = (lo + hi) / 2;
    (t * t * t * (2 - t) < share ? lo : hi) = t;
  }
  return lo;
}

float spot_cosine(const Light& light, float number) {
  const Cone cone(light);
  const float at = number * (cone.full + cone.edge);
  if (at < cone.full || cone.edge <= 0) return 1 - std::min(at, cone.full);
  const float t = inverse_edge(1 - (at - cone.full) / cone.edge);
  return ddgi::mix(light.cos_outer, light.cos_inner, t);
}

}  // namespace

Sphere sphere_around(const ddgi::Box& box) {
  if (box.empty()) return {};
  return {box.center(), ddgi::length(box.size()) / 2};
}

Emitter::Emitter(const Light& light, const Sphere& reach, std::vector<std::uint32_t> cells)
    : light_(light), reach_(reach), cells_(std::move(cells)) {}

Emitter::Emitter(const Light& light, const Sphere& reach) : Emitter(light, reach, {}) {
  for (std::uint32_t cell = 0; cell < kCells; ++cell) cells_.push_back(cell);
}

float Emitter::watts() const {
  const float colour = mean(light_.colour);
  switch (light_.type) {
    case LightType::sun: {
      const float share = static_cast<float>(cells_.size()) / static_cast<float>(kCells);
      return colour * 4 * reach_.radius * reach_.radius * share;
    }
    case LightType::point:
      return colour * 4 * kPi;
    case LightType::spot: {
      const Cone cone(light_);
      return colour * 2 * kPi * (cone.full + cone.edge);
    }
    case LightType::area:
      return colour * kPi * 4 * ddgi::length(ddgi::cross(light_.half_u, light_.half_v));
  }
  return 0;
}

Emission Emitter::emit(const std::array<float, 4>& n) const {
  const Vec3 d = ddgi::normalize(light_.direction);
  switch (light_.type) {
    case LightType::sun: {
      Vec3 u, v;
      ddgi::basis(d, u, v);
      const auto count = static_cast<float>(cells_.size());
      const float at = std::min(n[0] * count, count - 1);
      const std::uint32_t cell = cells_[static_cast<std::size_t>(at)];
      const float size = 2 * reach_.radius / static_cast<float>(kSide);
      const float x = (static_cast<float>(cell % kSide) + n[1]) * size - reach_.radius;
      const std::uint32_t row = cell / kSide;
      const float y = (static_cast<float>(row) + n[2]) * size - reach_.radius;
      return {reach_.center - d * reach_.radius + u * x + v * y, d};
    }
    case LightType::point:
      return {light_.position, around({0, 1, 0}, 1 - 2 * n[0], n[1])};
    case LightType::spot:
      return {light_.position, around(d, spot_cosine(light_, n[0]), n[1])};
    case LightType::area:
      break;
  }
  const Vec3 at = light_.position + light_.half_u * (2 * n[2] - 1) + light_.half_v * (2 * n[3] - 1);
  return {at, kinds::cosine_direction(d, n[0], n[1])};
}

bool same_photons(const Emitter& a, const Emitter& b) {
  const Light &x = a.light(), &y = b.light();
  const float p = mean(x.colour), q = mean(y.colour), little = 1e-4F * p * q;
  const Vec3 hue = x.colour * q - y.colour * p;
  return p > 0 && q > 0 && std::abs(hue.x) <= little && std::abs(hue.y) <= little &&
         std::abs(hue.z) <= little && x.type == y.type && x.position == y.position &&
         x.direction == y.direction && x.cos_inner == y.cos_inner && x.cos_outer == y.cos_outer &&
         x.half_u == y.half_u && x.half_v == y.half_v &&
         std::equal(a.cells().begin(), a.cells().end(), b.cells().begin(), b.cells().end());
}

std::array<float, 4> even_numbers(std::uint32_t seed, std::uint32_t index) {
  // 2³² over the first powers of the root of x⁵ = x + 1.
  constexpr std::array<std::uint32_t, 4> kSteps{3679390609U, 3152041523U, 2700274806U, 2313257605U};
  std::array<float, 4> numbers{};
  for (std::uint32_t i = 0; i < 4; ++i) {
    numbers[i] = ddgi::unit(ddgi::hash(seed, i) + (index + 1) * kSteps[i]);
  }
  return numbers;
}

}  // namespace gicodec::photons
