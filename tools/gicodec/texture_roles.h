// What flags for all textures leave alone: beside textures of light there may be some that say
// something about it, and are read bit by bit.
#pragma once

#include <gicodec/kind.h>
#include <gicodec/texture.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gicodec::tools {

/// By texture: whether its blocks are single records, states of probes, beside textures whose
/// blocks are more.
[[nodiscard]] std::vector<bool> are_states(std::span<const TextureDesc> textures);

/// By texture of a volume, of which there are so many: false for one that is to be exact, and for
/// those of a group that nothing is shown of beside groups that are.
[[nodiscard]] std::vector<bool> shown_textures(const VolumeDesc& volume, std::size_t textures);

/// By texture: false for states, integers that count or name, compressed blocks, and what is not
/// `shown`, beside others; true for all if nothing else is there.
[[nodiscard]] std::vector<bool> are_light(std::span<const TextureDesc> textures,
                                          const std::vector<bool>& shown);

/// --max-error of each texture: E counts for those that are light, NAME=E for any.
[[nodiscard]] std::vector<float> max_errors(const std::vector<std::string>& values,
                                            std::span<const std::string> names,
                                            std::span<const TextureDesc> textures,
                                            const std::vector<bool>& light);
/// Which textures an E leaves exact, in words that name the cure; empty if there are none.
[[nodiscard]] std::string left_exact(const std::vector<std::string>& values,
                                     std::span<const std::string> names,
                                     const std::vector<bool>& light);

}  // namespace gicodec::tools
