// Where probes and camera stand in a scene that says neither.
#pragma once

#include "ray_scene.h"

#include <optional>

namespace gicodec::ddgi {

/// The box of the scene at rest, shrunk by 2 %. Along an axis in which the scene is flat, an eighth
/// of its greatest extent instead, centred.
[[nodiscard]] Box inner_box(const Box& bounds);
/// A quarter of its greatest extent beyond the bounds on all sides: for a solid that is seen from
/// outside.
[[nodiscard]] Box outer_box(const Box& bounds);

/// inner_box(), or outer_box() where that lies inside of solids altogether.
[[nodiscard]] Box find_volume(const RayScene& scene);
/// The view that sees most lit surfaces, of some in the inner box and some that look at the scene
/// from outside; nullopt where none sees a surface from its front. `lit` becomes false if no light
/// reaches what it sees.
struct View {
  Camera camera;
  bool lit = false;
};
[[nodiscard]] std::optional<View> find_view(const RayScene& scene);

}  // namespace gicodec::ddgi
