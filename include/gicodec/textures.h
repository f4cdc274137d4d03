// Plain textures: 2D maps, 3D textures, arrays cut into blocks, and pools of bricks, as engines use
// them besides square probes (<gicodec/engines.h>).
#pragma once

#include <gicodec/api.h>
#include <gicodec/kind.h>
#include <gicodec/texture.h>

#include <cstdint>
#include <span>

namespace GICODEC_API gicodec {

inline constexpr std::uint8_t kKindTextures = 3;

/// A texture of `records` along each axis, cut into blocks of at most `block`. Array slices: blocks
/// of depth 1. Its memory is that of the uncut texture (Tiling::slices_xy_z).
[[nodiscard]] TextureDesc map_texture(const Record& record, Grid records,
                                      BlockShape block) noexcept;

/// A pool of `bricks` in one 3D texture of `slots` bricks along each axis, x fastest.
[[nodiscard]] TextureDesc brick_texture(const Record& record, std::uint32_t bricks,
                                        BlockShape brick, Grid slots) noexcept;

/// Kind 3: any texture groups without presence, dependencies and ranks.
extern const Kind kTextures;
/// A volume of this kind. invalid_description if the groups do not make one.
[[nodiscard]] Result<VolumeDesc> texture_volume(std::span<const TextureGroup> groups);

}  // namespace gicodec
