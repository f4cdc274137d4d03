// Plain textures: 2D maps, 3D textures and arrays cut into blocks, pools of bricks; what engines
// have besides square probes (<gicodec/engines.h>).
#pragma once

#include <gicodec/api.h>
#include <gicodec/kind.h>
#include <gicodec/texture.h>

#include <cstdint>
#include <span>

namespace GICODEC_API gicodec {

inline constexpr std::uint8_t kKindTextures = 3;

/// A texture of that many records along x, y and z (slices of an array: blocks of depth 1), cut
/// into blocks of at most this shape. In memory it is the texture as it is.
[[nodiscard]] TextureDesc map_texture(const Record& record, Grid records,
                                      BlockShape block) noexcept;

/// A pool of `bricks`, which stand side by side in one 3D texture of `slots` bricks along each
/// axis, x fastest.
[[nodiscard]] TextureDesc brick_texture(const Record& record, std::uint32_t bricks,
                                        BlockShape brick, Grid slots) noexcept;

/// Kind 3: any groups of textures, without presence, dependencies and ranks.
extern const Kind kTextures;
/// A volume of this kind. invalid_description if the groups do not make one.
[[nodiscard]] Result<VolumeDesc> texture_volume(std::span<const TextureGroup> groups);

}  // namespace gicodec
