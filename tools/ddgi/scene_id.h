// Which scene both ends mean: the server sends it, clients that draw it compare.
#pragma once

#include "scene.h"

#include <gicodec/protocol.h>

#include <optional>
#include <string>

namespace gicodec::ddgi {

/// The label as it is sent: UTF-8 without control characters, cut to what a Welcome takes.
[[nodiscard]] std::string scene_name(const std::string& label);

/// A label and a hash of the triangles at rest, where they stand, and which of them move.
[[nodiscard]] SceneId scene_id(const std::string& label, const Scene& scene);

/// Why probes of the scene `served` must not light `own`, and what to do; nothing if they may.
[[nodiscard]] std::optional<std::string> refusal(const SceneId& own, const SceneId& served);

}  // namespace gicodec::ddgi
