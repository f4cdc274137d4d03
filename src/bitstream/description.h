// Texture descriptions as bytes (FORMAT.md, "Records, blocks, textures").
#pragma once

#include <gicodec/kind.h>
#include <gicodec/texture.h>

#include "base/bytes.h"

#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace gicodec {

void write_record(const Record& record, ByteWriter& writer);
/// Fails the reader unless the record is_valid() and has its shortest form.
[[nodiscard]] Record read_record(ByteReader& reader);

void write_grid(const Grid& grid, ByteWriter& writer);
/// Fails the reader if a side is above `most`.
[[nodiscard]] Grid read_grid(ByteReader& reader, std::uint32_t most) noexcept;

/// Writes all but the layout.
void write_texture(const TextureDesc& desc, ByteWriter& writer);
/// The inverse, with a default layout. Fails the reader unless validate() accepts the texture.
[[nodiscard]] TextureDesc read_texture(ByteReader& reader);

/// Appends a volume's description. unknown_kind; invalid_description unless it reads back as given.
[[nodiscard]] Status write_volume_desc(const VolumeDesc& volume, std::span<const Kind* const> kinds,
                                       std::vector<std::byte>& out);

/// corrupt in place of a status that says that what was read makes no volume.
constexpr Status status_of_read(Status status) {
  const bool keeps =
      status == Status::ok || status == Status::out_of_memory || status == Status::limit_exceeded;
  return keeps ? status : Status::corrupt;
}

/// The layout of the texture of that name, from a container or a server.
struct TextureLayout {
  std::string_view name;
  Layout layout;
};
/// Reads the volume of a kind's description and gives its textures these layouts, in their order.
/// unknown_kind; corrupt unless their names and number agree and all is valid.
[[nodiscard]] Result<VolumeDesc> read_volume_desc(std::uint8_t kind,
                                                  std::span<const std::byte> description,
                                                  std::span<const TextureLayout> layouts,
                                                  std::span<const Kind* const> kinds);

/// The group of a texture, which exists, and the id of that group's first texture.
[[nodiscard]] std::pair<const TextureGroup*, std::uint8_t> group_of(const VolumeDesc& volume,
                                                                    std::uint8_t texture) noexcept;

/// The checksum of write_texture()'s bytes, which a keyframe holds as its base.
[[nodiscard]] std::uint32_t description_hash(const TextureDesc& desc);

}  // namespace gicodec
