#include "scenes.h"

#include <array>

namespace gicodec::ddgi {

std::span<const SceneInfo> built_in_scenes() {
  static constexpr std::array<SceneInfo, 3> scenes{{
      {"tomb", "closed room, the roof caves in, sunlight enters", {16, 8, 16}, 185388, make_tomb},
      {"villa", "fast day and night, an orrery in the sun's way", {16, 8, 32}, 178447, make_villa},
      {"street", "night, police lights, a car with head lamps", {32, 4, 64}, 414458, make_street},
  }};
  return scenes;
}

bool is_built_in(std::string_view name) {
  const auto scenes = built_in_scenes();
  return std::any_of(scenes.begin(), scenes.end(),
                     [&](const SceneInfo& info) { return info.name == name; });
}

std::optional<Scene> make_scene(std::string_view name) {
  for (const SceneInfo& info : built_in_scenes()) {
    if (info.name == name) return info.make();
  }
  return std::nullopt;
}

}  // namespace gicodec::ddgi
