// A scene as Embree sees it: which surface a ray meets, and whether light gets through.
#pragma once

#include "scene.h"

#include <memory>
#include <optional>

namespace gicodec::ddgi {

/// A point on a surface and what its material says there.
struct Surface {
  float distance = 0;
  bool back = false;  ///< hit from behind a one-sided surface; normals still point in front
  Vec3 position;
  Vec3 geometric_normal;  ///< of the triangle, unit length
  Vec3 normal;            ///< interpolated, unit length
  Vec3 albedo;            ///< reflected share, at most 0.9 in each channel
  Vec3 emission;          ///< radiance
  std::uint32_t object = 0, mesh = 0, triangle = 0;  ///< by the scene's numbers
  float u = 0, v = 0;  ///< weights of the triangle's second and third corner, unclamped
};

/// The scene must outlive it. Queries may run on many threads at once, but not beside set_state().
/// The same queries give the same bits on every x86-64 machine: the instruction set is fixed. Rays
/// whose origin or direction is not finite, or beyond 1e15, meet nothing.
class RayScene {
 public:
  /// Throws tools::Error where Embree cannot be started or memory is short.
  explicit RayScene(const Scene& scene);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  /// Moves the dynamic objects and switches lights, emission and sky. An object stays where it was
  /// if its transform has numbers that are not finite, or beyond 1e15.
  void set_state(FrameState state);
  [[nodiscard]] const FrameState& state() const noexcept;
  [[nodiscard]] const Scene& scene() const noexcept;

  /// The nearest surface along the unit vector `direction`. `spread` is the width of the sampled
  /// cone per metre of distance and selects how sharp textures are read.
  [[nodiscard]] std::optional<Surface> intersect(Vec3 origin, Vec3 direction, float spread) const;
  /// Whether the nearest surface of the objects that never move is seen from behind.
  [[nodiscard]] bool behind_static_surface(Vec3 origin, Vec3 direction) const;
  [[nodiscard]] bool occluded(Vec3 origin, Vec3 direction, float distance) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Origin for rays that leave a surface on the side of `normal`.
[[nodiscard]] Vec3 leave(const Surface& surface, Vec3 normal);

}  // namespace gicodec::ddgi
