// Vectors, rigid and affine transforms, angles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace gicodec::ddgi {

inline constexpr float kPi = 3.14159265358979323846F;

struct Vec2 {
  float x = 0, y = 0;
};

struct Vec3 {
  float x = 0, y = 0, z = 0;

  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  friend constexpr Vec3 operator*(Vec3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr Vec3 operator*(float s, Vec3 a) { return a * s; }
  friend constexpr Vec3 operator/(Vec3 a, float s) { return a * (1.0F / s); }
  constexpr Vec3& operator+=(Vec3 b) { return *this = *this + b; }
  constexpr Vec3& operator*=(float s) { return *this = *this * s; }
  friend constexpr bool operator==(Vec3, Vec3) = default;
};

[[nodiscard]] constexpr float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline float length(Vec3 a) { return std::sqrt(dot(a, a)); }
/// The zero vector stays what it is.
[[nodiscard]] inline Vec3 normalize(Vec3 a) {
  const float l = length(a);
  return l > 0 ? a * (1.0F / l) : a;
}
/// Unit vector from one point towards another, also where their distance overflows a float; zero
/// where they are the same. Finite points only.
[[nodiscard]] inline Vec3 direction_between(Vec3 from, Vec3 to) {
  const double x = double{to.x} - from.x, y = double{to.y} - from.y, z = double{to.z} - from.z;
  const double l = std::sqrt(x * x + y * y + z * z);
  if (!(l > 0)) return {};
  return {static_cast<float>(x / l), static_cast<float>(y / l), static_cast<float>(z / l)};
}
[[nodiscard]] constexpr Vec3 lerp(Vec3 a, Vec3 b, float t) { return a + (b - a) * t; }
[[nodiscard]] constexpr float mix(float a, float b, float t) { return a + (b - a) * t; }
[[nodiscard]] constexpr float saturate(float a) { return std::clamp(a, 0.0F, 1.0F); }
[[nodiscard]] constexpr float smoothstep(float lo, float hi, float x) {
  const float t = saturate((x - lo) / (hi - lo));
  return t * t * (3 - 2 * t);
}
[[nodiscard]] constexpr Vec3 min(Vec3 a, Vec3 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
[[nodiscard]] constexpr Vec3 max(Vec3 a, Vec3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
[[nodiscard]] constexpr float radians(float degrees) { return degrees * (kPi / 180.0F); }

/// Linear part by columns, then translation.
struct Affine {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, t{0, 0, 0};

  [[nodiscard]] constexpr Vec3 vector(Vec3 v) const { return x * v.x + y * v.y + z * v.z; }
  [[nodiscard]] constexpr Vec3 point(Vec3 p) const { return vector(p) + t; }
  [[nodiscard]] constexpr float determinant() const { return dot(x, cross(y, z)); }
  /// Direction of a transformed normal (inverse transpose); not normalised.
  [[nodiscard]] constexpr Vec3 normal(Vec3 n) const {
    const Vec3 v = cross(y, z) * n.x + cross(z, x) * n.y + cross(x, y) * n.z;
    return determinant() < 0 ? -v : v;
  }
  friend constexpr Affine operator*(const Affine& a, const Affine& b) {
    return {a.vector(b.x), a.vector(b.y), a.vector(b.z), a.point(b.t)};
  }
  friend constexpr bool operator==(const Affine&, const Affine&) = default;
};

[[nodiscard]] constexpr Affine translation(Vec3 t) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, t}; }
[[nodiscard]] constexpr Affine scaling(Vec3 s) {
  return {{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}, {0, 0, 0}};
}

/// Unit quaternion.
struct Quat {
  float x = 0, y = 0, z = 0, w = 1;

  [[nodiscard]] constexpr Affine affine() const {
    return {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
            {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
            {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)},
            {0, 0, 0}};
  }
};

/// Right-handed rotation about an axis through the origin.
[[nodiscard]] inline Quat axis_angle(Vec3 axis, float angle) {
  const Vec3 v = normalize(axis) * std::sin(angle / 2);
  return {v.x, v.y, v.z, std::cos(angle / 2)};
}
[[nodiscard]] inline Affine rotation(Vec3 axis, float angle) {
  return axis_angle(axis, angle).affine();
}

/// Two unit vectors that make a right-handed basis with the unit vector n.
inline void basis(Vec3 n, Vec3& u, Vec3& v) {
  u = normalize(cross(std::abs(n.y) < 0.99F ? Vec3{0, 1, 0} : Vec3{1, 0, 0}, n));
  v = cross(n, u);
}

struct Box {
  Vec3 lo{1e30F, 1e30F, 1e30F}, hi{-1e30F, -1e30F, -1e30F};

  constexpr void add(Vec3 p) { lo = min(lo, p), hi = max(hi, p); }
  [[nodiscard]] constexpr bool empty() const { return lo.x > hi.x; }
  [[nodiscard]] constexpr Vec3 size() const { return hi - lo; }
  [[nodiscard]] constexpr Vec3 center() const { return (lo + hi) * 0.5F; }
};

/// From and to places as the library has them.
[[nodiscard]] constexpr Vec3 vec(const std::array<float, 3>& p) { return {p[0], p[1], p[2]}; }
[[nodiscard]] constexpr std::array<float, 3> position(Vec3 v) { return {v.x, v.y, v.z}; }

/// +x, −x, +y, −y, +z, −z.
[[nodiscard]] constexpr Vec3 axis_of(std::size_t direction) {
  const float sign = direction % 2 == 0 ? 1.0F : -1.0F;
  return direction < 2 ? Vec3{sign, 0, 0} : direction < 4 ? Vec3{0, sign, 0} : Vec3{0, 0, sign};
}

}  // namespace gicodec::ddgi
