// Frames of a client: how blocks get from one to the other.
#pragma once

#include <gicodec/client.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec {

/// Copies a block, guard band included, between tightly packed textures of the same block size.
void copy_block(const TextureDesc& from_desc, std::span<const std::byte> from,
                std::uint32_t from_block, const TextureDesc& to_desc, std::span<std::byte> to,
                std::uint32_t to_block) noexcept;

}  // namespace gicodec
