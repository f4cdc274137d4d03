// Flags that choose the scene and the volume.
#pragma once

#include "common/command_line.h"
#include "ddgi/client_renderer.h"
#include "ddgi/scene.h"
#include "ddgi/volume.h"

#include <cstdint>
#include <optional>
#include <string>

namespace gicodec::kinds {

struct SceneFlags {
  std::string scene;     ///< name of a built-in scene
  std::string gltf;      ///< a glTF 2.0 file instead
  bool outside = false;  ///< the glTF file may refer to files outside of its folder
  std::string grid;      ///< "16x8x16"; empty for the scene's own
  std::string bounds;    ///< "x0,y0,z0,x1,y1,z1" from the first to the last probe; or empty
};

void add_scene_flags(tools::Command& app, SceneFlags& flags);
/// Throws tools::Error for an unknown scene or a file that cannot be used.
[[nodiscard]] ddgi::Scene load_scene(const SceneFlags& flags);
/// "villa" or "room.glb", for messages, attributes and JSON; UTF-8.
[[nodiscard]] std::string scene_label(const SceneFlags& flags);
/// Sets the scene's grid and box by the flags. Throws tools::Error of Exit::usage.
void place_volume(const SceneFlags& flags, ddgi::Scene& scene);
/// Grid and place of the flags, else of the scene.
[[nodiscard]] ddgi::VolumeShape volume_of(const SceneFlags& flags, const ddgi::Scene& scene);
/// Options of pictures of a size such as "960x540", at most 16384x16384. `example`: a size for the
/// message. Throws tools::Error of Exit::usage.
[[nodiscard]] ddgi::RenderOptions picture_options(const std::string& size, std::uint32_t samples,
                                                  const char* example);
/// "1,2.5,-3" with exactly `count` finite numbers. Throws tools::Error of Exit::usage.
[[nodiscard]] std::vector<float> numbers(const std::string& text, std::size_t count,
                                         const char* what);

}  // namespace gicodec::kinds
