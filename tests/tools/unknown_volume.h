// A volume of a kind that no program knows, for containers of tests.
#pragma once

#include <gicodec/container.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace gicodec::test {

/// Adds a volume with one texture, "surfels".
inline void add_unknown_volume(ContainerDescription& container, const std::string& name,
                               std::uint8_t kind, std::vector<std::byte> description) {
  VolumeEntry volume;
  volume.name = name;
  volume.kind = kind;
  volume.description = std::move(description);
  volume.first_texture = static_cast<std::uint32_t>(container.textures.size());
  volume.textures = 1;
  TextureEntry texture;
  texture.name = "surfels";
  texture.volume = static_cast<std::uint32_t>(container.volumes.size());
  container.volumes.push_back(std::move(volume));
  container.textures.push_back(std::move(texture));
}

}  // namespace gicodec::test
