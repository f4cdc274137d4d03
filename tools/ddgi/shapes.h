// Procedural shapes. Each adds triangles to a mesh; texture coordinates are metres times a scale.
#pragma once

#include "scene.h"

#include <span>

namespace gicodec::ddgi {

class MeshBuilder {
 public:
  /// `tile`: metres that one repetition of the image covers.
  explicit MeshBuilder(std::uint32_t material, float tile = 1) : scale_(1 / tile) {
    mesh_.material = material;
  }

  /// Placement of what is added from here on.
  MeshBuilder& at(const Affine& transform) {
    transform_ = transform;
    return *this;
  }
  MeshBuilder& at(Vec3 position) { return at(translation(position)); }

  /// A surface over [0, 1]² of cells_u × cells_v quads. The front looks along dP/du × dP/dv.
  /// `position` must be defined a little outside of [0, 1]². `extent` is its size in metres.
  MeshBuilder& surface(std::uint32_t cells_u, std::uint32_t cells_v, Vec2 extent,
                       const std::function<Vec3(float, float)>& position);
  /// A flat parallelogram from `corner`; the front looks along u × v. Cut into cells.
  MeshBuilder& patch(Vec3 corner, Vec3 u, Vec3 v, std::uint32_t cells_u = 1,
                     std::uint32_t cells_v = 1);
  /// A box, its front outside, or inside for a room.
  MeshBuilder& box(Vec3 lo, Vec3 hi, bool inside = false, std::uint32_t cells = 1);
  /// A box with rounded edges of radius r and slightly uneven faces (dressed stone).
  MeshBuilder& stone(Vec3 lo, Vec3 hi, float r, float uneven, std::uint32_t seed,
                     std::uint32_t cells = 6);
  /// Turns a profile of (radius, height), listed from bottom to top, around the y axis; closed
  /// where it ends at radius 0. `flutes` > 0 carves a column's grooves of that depth.
  MeshBuilder& lathe(std::span<const Vec2> profile, std::uint32_t segments,
                     std::uint32_t flutes = 0, float depth = 0);
  MeshBuilder& sphere(Vec3 center, float radius, std::uint32_t segments, float uneven = 0,
                      std::uint32_t seed = 0);
  MeshBuilder& ellipsoid(Vec3 center, Vec3 radii, std::uint32_t segments, float uneven = 0,
                         std::uint32_t seed = 0);
  MeshBuilder& torus(Vec3 center, Vec3 axis, float major, float minor, std::uint32_t segments,
                     std::uint32_t sides);
  MeshBuilder& cylinder(Vec3 from, Vec3 to, float radius, std::uint32_t segments);
  /// Extrudes a convex outline of (z, y), counter-clockwise, along x from x0 to x1, with caps.
  MeshBuilder& prism(std::span<const Vec2> outline, float x0, float x1);

  [[nodiscard]] Mesh take() { return std::move(mesh_); }

 private:
  std::uint32_t vertex(Vec3 position, Vec3 normal, Vec2 uv);
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void quad(Vec3 a, Vec3 b, Vec3 c, Vec3 d);

  Mesh mesh_;
  Affine transform_;
  float scale_;
};

}  // namespace gicodec::ddgi
