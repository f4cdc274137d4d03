// What glTF has no words for: sky, probe volume and exposure, in the extras of a glTF scene under
// the name "gicodec" (docs/ddgi.md).
#pragma once

#include "gltf_accessor.h"
#include "scene.h"

#include <optional>

namespace tinygltf {
class Value;
}

namespace gicodec::ddgi {

/// Each part may be missing.
struct GltfExtras {
  struct Volume {
    Grid grid;
    Box box;  ///< from the first to the last probe
  };
  std::optional<Sky> sky;
  std::optional<Volume> volume;
  std::optional<float> exposure;
};

[[nodiscard]] tinygltf::Value to_value(const GltfExtras& extras);
/// `extras`: those of the glTF scene. Throws tools::Error of Exit::bad_input for parts that make no
/// sense.
[[nodiscard]] GltfExtras read_extras(const tinygltf::Value& extras, const AccessorReader& reader);

/// Unit length for any vector but zero. What is of that length but for rounding keeps its bits, so
/// that directions survive a file.
[[nodiscard]] inline Vec3 direction(Vec3 v) {
  return std::abs(dot(v, v) - 1) < 1e-6F ? v : normalize(v);
}

}  // namespace gicodec::ddgi
