// A scene with a column that twists: points that move within their instance, which the tracer's
// scenes do not have.
#pragma once

#include "ao/sample_elimination.h"
#include "ddgi/scene.h"

#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace gicodec::ao {

class TwistingColumn {
 public:
  static constexpr float kHeight = 5, kHalf = 0.8F;  ///< metres
  /// Its corners come no further out of the box at rest.
  static constexpr float kMargin = 0.42F * kHalf;

  /// Adds the column to a scene, standing at a place of a floor.
  TwistingColumn(ddgi::Scene& scene, ddgi::Vec3 foot) {
    ddgi::Mesh mesh;
    for (int side = 0; side < 4; ++side) {
      const ddgi::Affine turned =
          ddgi::rotation({0, 1, 0}, static_cast<float>(side) * ddgi::kPi / 2);
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (std::uint32_t j = 0; j <= kDown; ++j) {
        for (std::uint32_t i = 0; i <= kAcross; ++i) {
          const float x = 2 * static_cast<float>(i) / kAcross - 1;
          const float y = static_cast<float>(j) / kDown;
          mesh.positions.push_back(turned.point({kHalf * x, kHeight * y, kHalf}));
          mesh.normals.push_back(turned.vector({0, 0, 1}));
          mesh.uvs.push_back({x, y});
        }
      }
      for (std::uint32_t j = 0; j < kDown; ++j) {
        for (std::uint32_t i = 0; i < kAcross; ++i) {
          const std::uint32_t a = first + j * (kAcross + 1) + i, b = a + kAcross + 1;
          mesh.triangles.push_back({a, a + 1, b + 1});
          mesh.triangles.push_back({a, b + 1, b});
        }
      }
    }
    mesh.material = scene.add_material({.name = "column"});
    mesh_ = scene.add_mesh(std::move(mesh));
    object_ = scene.add_object({.name = "column",
                                .meshes = {mesh_},
                                .transform = ddgi::translation(foot),
                                .dynamic = true});
  }

  [[nodiscard]] std::uint32_t object() const { return object_; }

  /// The scene as it is at that time; `rest` is the one that the column was added to.
  [[nodiscard]] ddgi::Scene at(const ddgi::Scene& rest, double time) const {
    ddgi::Scene scene = rest;
    ddgi::Mesh& mesh = scene.meshes[mesh_];
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      twist(time, mesh.positions[i], mesh.normals[i]);
    }
    return scene;
  }
  /// Points at rest to where they are at that time.
  static void move(double time, std::span<const SurfacePoint> rest, std::span<SurfacePoint> now) {
    for (std::size_t i = 0; i < rest.size(); ++i) {
      now[i] = rest[i];
      twist(time, now[i].position, now[i].normal);
      now[i].geometric = now[i].normal;
    }
  }

 private:
  static constexpr std::uint32_t kAcross = 32, kDown = 100;

  static void twist(double time, ddgi::Vec3& position, ddgi::Vec3& normal) {
    const float rate = 0.7F * static_cast<float>(std::sin(1.5 * time)) / kHeight;
    const ddgi::Affine turn = ddgi::rotation({0, 1, 0}, rate * position.y);
    position = turn.point(position);
    // The derivative along y leans with the twist.
    const ddgi::Vec3 n = turn.vector(normal);
    const ddgi::Vec3 along = cross({0, 1, 0}, position) * rate;
    normal = normalize(ddgi::Vec3{n.x, n.y - dot(n, along), n.z});
  }

  std::uint32_t mesh_ = 0, object_ = 0;
};

}  // namespace gicodec::ao
