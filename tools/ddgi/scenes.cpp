#include "scenes.h"

#include <array>

namespace gicodec::ddgi {

std::span<const SceneInfo> built_in_scenes() {
  static constexpr std::array<SceneInfo, 3> scenes{{
      {"tomb", "closed room, the roof caves in, sunlight enters", make_tomb},
      {"villa", "fast day and night, an orrery in the sun's way", make_villa},
      {"street", "night, police lights, a car with head lamps", make_street},
  }};
  return scenes;
}

std::optional<Scene> make_scene(std::string_view name) {
  for (const SceneInfo& info : built_in_scenes()) {
    if (info.name == name) return info.make();
  }
  return std::nullopt;
}

}  // namespace gicodec::ddgi
