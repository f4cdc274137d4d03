#include "shapes.h"

#include "noise.h"

namespace gicodec::ddgi {

std::uint32_t MeshBuilder::vertex(Vec3 position, Vec3 normal, Vec2 uv) {
  mesh_.positions.push_back(transform_.point(position));
  mesh_.normals.push_back(normalize(transform_.normal(normal)));
  mesh_.uvs.push_back({uv.x * scale_, uv.y * scale_});
  return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
}

void MeshBuilder::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (transform_.determinant() < 0) std::swap(b, c);
  const auto& p = mesh_.positions;
  const Vec3 n = cross(p[b] - p[a], p[c] - p[a]);
  if (dot(n, n) > 1e-16F) mesh_.triangles.push_back({a, b, c});
}

MeshBuilder& MeshBuilder::surface(std::uint32_t cells_u, std::uint32_t cells_v, Vec2 extent,
                                  const std::function<Vec3(float, float)>& position) {
  const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
  const auto nu = static_cast<float>(cells_u), nv = static_cast<float>(cells_v);
  const float hu = 0.25F / nu, hv = 0.25F / nv;
  for (std::uint32_t j = 0; j <= cells_v; ++j) {
    for (std::uint32_t i = 0; i <= cells_u; ++i) {
      const float u = static_cast<float>(i) / nu, v = static_cast<float>(j) / nv;
      const auto normal = [&](float un, float vn) {
        return cross(position(un + hu, vn) - position(un - hu, vn),
                     position(un, vn + hv) - position(un, vn - hv));
      };
      Vec3 n = normal(u, v);
      // At a pole one derivative vanishes: take the normal of just beside it.
      if (dot(n, n) < 1e-14F) n = normal(u, v < 0.5F ? v + 2 * hv : v - 2 * hv);
      vertex(position(u, v), n, {u * extent.x, v * extent.y});
    }
  }
  for (std::uint32_t j = 0; j < cells_v; ++j) {
    for (std::uint32_t i = 0; i < cells_u; ++i) {
      const std::uint32_t a = first + j * (cells_u + 1) + i, b = a + 1, c = a + cells_u + 2,
                          d = a + cells_u + 1;
      triangle(a, b, c);
      triangle(a, c, d);
    }
  }
  return *this;
}

MeshBuilder& MeshBuilder::patch(Vec3 corner, Vec3 u, Vec3 v, std::uint32_t cells_u,
                                std::uint32_t cells_v) {
  return surface(cells_u, cells_v, {length(u), length(v)},
                 [=](float s, float t) { return corner + u * s + v * t; });
}

void MeshBuilder::quad(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 n = cross(b - a, d - a);
  const float w = length(b - a), h = length(d - a);
  const std::uint32_t i = vertex(a, n, {0, 0});
  vertex(b, n, {w, 0});
  vertex(c, n, {w, h});
  vertex(d, n, {0, h});
  triangle(i, i + 1, i + 2);
  triangle(i, i + 2, i + 3);
}

MeshBuilder& MeshBuilder::box(Vec3 lo, Vec3 hi, bool inside, std::uint32_t cells) {
  const Vec3 s = hi - lo, x{s.x, 0, 0}, y{0, s.y, 0}, z{0, 0, s.z};
  const auto face = [&](Vec3 corner, Vec3 u, Vec3 v) {
    if (inside) {
      patch(corner + u, -u, v, cells, cells);
    } else {
      patch(corner, u, v, cells, cells);
    }
  };
  face(lo + z, x, y);
  face(lo + x, -x, y);
  face(lo, z, y);
  face(lo + x + z, -z, y);
  face(lo + y + z, x, -z);
  face(lo, x, z);
  return *this;
}

MeshBuilder& MeshBuilder::stone(Vec3 lo, Vec3 hi, float r, float uneven, std::uint32_t seed,
                                std::uint32_t cells) {
  const Vec3 center = (lo + hi) * 0.5F, half = (hi - lo) * 0.5F;
  const Vec3 core = max(half - Vec3{r, r, r}, Vec3{0, 0, 0});
  // Points of the box are pulled to the rounded box around `core`; noise depends on the point
  // alone, so the six faces stay joined.
  const auto shape = [=](Vec3 p) {
    const Vec3 q = max(min(p, core), -core);
    const Vec3 out = normalize(p - q);
    const Vec3 n = (center + p) * 1.7F + Vec3{static_cast<float>(seed % 97), 0, 0};
    return center + q + out * (r + uneven * (noise(n, 0, seed) - 0.5F));
  };
  const Vec3 x{half.x, 0, 0}, y{0, half.y, 0}, z{0, 0, half.z};
  const auto face = [&](Vec3 n, Vec3 u, Vec3 v) {
    surface(cells, cells, {2 * length(u), 2 * length(v)}, [=](float s, float t) {
      return shape(n + u * (2 * std::clamp(s, 0.0F, 1.0F) - 1) +
                   v * (2 * std::clamp(t, 0.0F, 1.0F) - 1));
    });
  };
  face(z, x, y);
  face(-z, -x, y);
  face(-x, z, y);
  face(x, -z, y);
  face(y, x, -z);
  face(-y, x, z);
  return *this;
}

MeshBuilder& MeshBuilder::lathe(std::span<const Vec2> profile, std::uint32_t segments,
                                std::uint32_t flutes, float depth) {
  const std::size_t last = profile.size() - 1;
  float height = 0, radius = 0;
  for (std::size_t i = 0; i < last; ++i) {
    height += std::hypot(profile[i + 1].x - profile[i].x, profile[i + 1].y - profile[i].y);
    radius = std::max(radius, profile[i + 1].x);
  }
  // v runs along the listed points in equal steps; u against the clock, so fronts are outside.
  return surface(
      segments, static_cast<std::uint32_t>(last), {2 * kPi * radius, height},
      [=](float u, float v) {
        const float f = std::clamp(v, 0.0F, 1.0F) * static_cast<float>(last);
        const auto i = std::min(static_cast<std::size_t>(f), last - 1);
        const float t = f - static_cast<float>(i);
        const float r0 = mix(profile[i].x, profile[i + 1].x, t);
        const float y = mix(profile[i].y, profile[i + 1].y, t);
        const float angle = -2 * kPi * u;
        const float groove =
            flutes ? depth * std::abs(std::sin(angle * static_cast<float>(flutes) / 2)) - depth : 0;
        const float r = std::max(0.0F, r0 + groove);
        return Vec3{r * std::cos(angle), y, r * std::sin(angle)};
      });
}

MeshBuilder& MeshBuilder::ellipsoid(Vec3 center, Vec3 radii, std::uint32_t segments, float uneven,
                                    std::uint32_t seed) {
  const float r = std::max({radii.x, radii.y, radii.z});
  return surface(
      segments, std::max(2U, segments / 2), {2 * kPi * r, kPi * r}, [=](float u, float v) {
        const float phi = -2 * kPi * u, theta = kPi * v;
        const Vec3 d{std::sin(theta) * std::cos(phi), -std::cos(theta),
                     std::sin(theta) * std::sin(phi)};
        const float bump = uneven > 0 ? 1 + uneven * (fbm(d * 2.5F, 3, 0, seed) - 0.5F) : 1;
        return center + d * radii * bump;
      });
}

MeshBuilder& MeshBuilder::sphere(Vec3 center, float radius, std::uint32_t segments, float uneven,
                                 std::uint32_t seed) {
  return ellipsoid(center, {radius, radius, radius}, segments, uneven, seed);
}

MeshBuilder& MeshBuilder::torus(Vec3 center, Vec3 axis, float major, float minor,
                                std::uint32_t segments, std::uint32_t sides) {
  const Vec3 n = normalize(axis);
  Vec3 a, b;
  basis(n, a, b);
  return surface(segments, sides, {2 * kPi * major, 2 * kPi * minor}, [=](float u, float v) {
    const float phi = 2 * kPi * u, theta = 2 * kPi * v;
    const Vec3 out = a * std::cos(phi) + b * std::sin(phi);
    return center + out * (major + minor * std::cos(theta)) + n * (minor * std::sin(theta));
  });
}

MeshBuilder& MeshBuilder::cylinder(Vec3 from, Vec3 to, float radius, std::uint32_t segments) {
  const Vec3 axis = to - from;
  const float h = length(axis);
  Vec3 a, b;
  basis(normalize(axis), a, b);
  const auto rim = [=](float u, float r) {
    const float phi = 2 * kPi * u;
    return a * (r * std::cos(phi)) + b * (r * std::sin(phi));
  };
  surface(segments, 1, {2 * kPi * radius, h},
          [=](float u, float v) { return from + axis * v + rim(u, radius); });
  surface(segments, 1, {2 * kPi * radius, radius},
          [=](float u, float v) { return to + rim(u, radius * (1 - v)); });
  return surface(segments, 1, {2 * kPi * radius, radius},
                 [=](float u, float v) { return from + rim(u, radius * v); });
}

MeshBuilder& MeshBuilder::prism(std::span<const Vec2> outline, float x0, float x1) {
  const std::size_t n = outline.size();
  const auto at = [&](std::size_t i, float x) {
    return Vec3{x, outline[i % n].y, outline[i % n].x};
  };
  for (std::size_t i = 0; i < n; ++i) quad(at(i, x0), at(i, x1), at(i + 1, x1), at(i + 1, x0));
  const auto cap = [&](float x, Vec3 normal, bool flip) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (std::size_t i = 0; i < n; ++i) vertex(at(i, x), normal, outline[i]);
    for (std::uint32_t i = 2; i < n; ++i) {
      flip ? triangle(first, first + i, first + i - 1) : triangle(first, first + i - 1, first + i);
    }
  };
  cap(x0, {-1, 0, 0}, false);
  cap(x1, {1, 0, 0}, true);
  return *this;
}

}  // namespace gicodec::ddgi
