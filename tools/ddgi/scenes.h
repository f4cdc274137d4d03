// The built-in scenes, in the sizes and characters of Stengel et al. (Figure 5).
#pragma once

#include "scene.h"

#include <optional>
#include <span>
#include <string_view>

namespace gicodec::ddgi {

/// A closed room under ground whose roof caves in while sunlight enters: all light and much of the
/// visibility changes. 16 × 8 × 16 probes.
[[nodiscard]] Scene make_tomb();
/// A villa in a fast cycle of day and night; static but for an orrery in the sun's way.
/// 16 × 8 × 32 probes.
[[nodiscard]] Scene make_villa();
/// A street at night, a police car's turning lights, a car with head lamps; about half of the
/// probes lie inside houses. 32 × 4 × 64 probes.
[[nodiscard]] Scene make_street();

struct SceneInfo {
  std::string_view name, summary;
  Grid grid;
  std::uint32_t triangles;
  Scene (*make)();
};
[[nodiscard]] std::span<const SceneInfo> built_in_scenes();
[[nodiscard]] bool is_built_in(std::string_view name);
/// nullopt for a name that is none of these.
[[nodiscard]] std::optional<Scene> make_scene(std::string_view name);

}  // namespace gicodec::ddgi
