// The thin client: primary visibility and direct light traced, diffuse indirect light read from
// probe textures.
#pragma once

#include "parallel.h"
#include "probe_field.h"
#include "ray_scene.h"

namespace gicodec::ddgi {

enum class RenderMode : std::uint8_t {
  full,    ///< direct and indirect light
  direct,  ///< lights and emission only
  gi,      ///< indirect light only
};

struct RenderOptions {
  std::uint32_t width = 960, height = 540;
  std::uint32_t samples = 2;  ///< rays per pixel in each direction, on a fixed grid
  RenderMode mode = RenderMode::full;
  bool (*stopped)() noexcept = nullptr;  ///< asked before each row; once true, rows stay black
};

/// Linear radiance, row by row from the top.
struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<Vec3> pixels;
};

/// Draws the scene in the state it is in. The same field gives the same bits, whatever the number
/// of threads. `field` may be nullptr for RenderMode::direct; `fine`, if given, is used in its
/// place where it reaches.
[[nodiscard]] Picture render(const RayScene& scene, const ProbeField* field, const Camera& camera,
                             const RenderOptions& options, ThreadPool& pool,
                             const ProbeField* fine = nullptr);

}  // namespace gicodec::ddgi
