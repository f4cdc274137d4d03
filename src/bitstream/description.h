// Texture descriptions as bytes (FORMAT.md, "Records, blocks, textures").
#pragma once

#include <gicodec/texture.h>

#include "base/bytes.h"

#include <cstdint>

namespace gicodec {

void write_record(const Record& record, ByteWriter& writer);
/// Fails the reader unless what it reads is_valid() and has no shorter form.
[[nodiscard]] Record read_record(ByteReader& reader);

void write_grid(const Grid& grid, ByteWriter& writer);
/// Sides of at most `most`.
[[nodiscard]] Grid read_grid(ByteReader& reader, std::uint32_t most) noexcept;

/// All but the layout.
void write_texture(const TextureDesc& desc, ByteWriter& writer);

/// The checksum of write_texture()'s bytes: what a packet is coded for.
[[nodiscard]] std::uint32_t description_hash(const TextureDesc& desc);

}  // namespace gicodec
