// Textures that flags for all textures leave exact: beside textures of light there may be some that
// describe it, and are read bit by bit.
#pragma once

#include <gicodec/kind.h>
#include <gicodec/texture.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gicodec::tools {

/// By texture: true if its blocks are single records (states of probes), beside larger blocks.
[[nodiscard]] std::vector<bool> are_states(std::span<const TextureDesc> textures);

/// By texture of a volume with `textures` textures: false for one with Threshold::exact, and for
/// those of a group without previews beside groups with some.
[[nodiscard]] std::vector<bool> shown_textures(const VolumeDesc& volume, std::size_t textures);

/// By texture: false for states, integers, compressed blocks, and those not `shown`; true for all
/// if no other remains.
[[nodiscard]] std::vector<bool> are_light(std::span<const TextureDesc> textures,
                                          const std::vector<bool>& shown);

/// --max-error of each texture: E applies to textures of light, NAME=E to any.
[[nodiscard]] std::vector<float> max_errors(const std::vector<std::string>& values,
                                            std::span<const std::string> names,
                                            std::span<const TextureDesc> textures,
                                            const std::vector<bool>& light);
/// The textures that E leaves exact, in words with a hint; empty if there are none.
[[nodiscard]] std::string left_exact(const std::vector<std::string>& values,
                                     std::span<const std::string> names,
                                     const std::vector<bool>& light);

}  // namespace gicodec::tools
