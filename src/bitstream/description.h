// Texture descriptions as bytes (FORMAT.md, "Records, blocks, textures").
#pragma once

#include <gicodec/kind.h>
#include <gicodec/texture.h>

#include "base/bytes.h"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace gicodec {

void write_record(const Record& record, ByteWriter& writer);
/// Fails the reader unless what it reads is_valid() and has no shorter form.
[[nodiscard]] Record read_record(ByteReader& reader);

void write_grid(const Grid& grid, ByteWriter& writer);
/// Sides of at most `most`.
[[nodiscard]] Grid read_grid(ByteReader& reader, std::uint32_t most) noexcept;

/// All but the layout.
void write_texture(const TextureDesc& desc, ByteWriter& writer);
/// In no particular layout. Fails the reader unless validate() accepts what it reads.
[[nodiscard]] TextureDesc read_texture(ByteReader& reader);

/// Appends the description of a volume. unknown_kind; invalid_description unless it gives the
/// volume back when it is read.
[[nodiscard]] Status write_volume_desc(const VolumeDesc& volume, std::span<const Kind* const> kinds,
                                       std::vector<std::byte>& out);

/// A texture as a container or a server tells of it.
struct ToldTexture {
  std::string_view name;
  Layout layout;
};
/// The volume that a kind's description tells of, with textures that stand like these.
/// unknown_kind; corrupt unless all of it agrees and is valid.
[[nodiscard]] Result<VolumeDesc> read_volume_desc(std::uint8_t kind,
                                                  std::span<const std::byte> description,
                                                  std::span<const ToldTexture> textures,
                                                  std::span<const Kind* const> kinds);

/// The checksum of write_texture()'s bytes: what a packet is coded for.
[[nodiscard]] std::uint32_t description_hash(const TextureDesc& desc);

}  // namespace gicodec
