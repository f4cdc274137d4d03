#include "scene_id.h"

#include "dump/text.h"
#include "scenes.h"

#include <fmt/core.h>

#include <algorithm>
#include <span>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace gicodec::ddgi {
namespace {

std::uint64_t extended(std::uint64_t hash, std::span<const std::byte> bytes) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), hash);
}

std::string flag_for(const std::string& name) {
  const bool built_in =
      std::ranges::any_of(built_in_scenes(), [&](const auto& info) { return info.name == name; });
  return fmt::format("--{} {}", built_in ? "scene" : "gltf", name);
}

}  // namespace

std::string scene_name(const std::string& label) {
  std::string name = tools::printable(label);
  if (name.size() <= kMaxName) return name;
  std::size_t end = kMaxName;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;
  return name.substr(0, end);
}

SceneId scene_id(const std::string& label, const Scene& scene) {
  std::uint64_t hash = 0;
  for (const Object& object : scene.objects) {
    hash = extended(hash, std::as_bytes(std::span(&object.transform, 1)));
    const auto dynamic = std::byte{object.dynamic};
    hash = extended(hash, std::span(&dynamic, 1));
    for (const std::uint32_t mesh : object.meshes) {
      hash = extended(hash, std::as_bytes(std::span(scene.meshes[mesh].positions)));
      hash = extended(hash, std::as_bytes(std::span(scene.meshes[mesh].triangles)));
    }
  }
  return {scene_name(label), std::max<std::uint64_t>(hash, 1)};
}

std::optional<std::string> refusal(const SceneId& own, const SceneId& served) {
  const bool known = served.geometry != 0 && own.geometry != 0;
  if (known ? served.geometry == own.geometry : served.name.empty() || served.name == own.name) {
    return std::nullopt;
  }
  const std::string name = tools::printable(served.name);
  if (served.name == own.name) {
    return fmt::format(
        "the server's {0} has other triangles than the {0} here: give both ends the same file",
        name);
  }
  if (served.name.empty()) {
    return fmt::format("the server streams another scene than {}: give both ends the same one",
                       own.name);
  }
  return fmt::format("the server streams {}, and the scene here is {}: use {}", name, own.name,
                     flag_for(name));
}

}  // namespace gicodec::ddgi
