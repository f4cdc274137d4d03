// Metadata of containers: pairs of text in descriptions, and what a texture has besides, packed by
// itself (FORMAT.md, "Container").
#pragma once

#include <gicodec/container.h>

#include "base/bytes.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gicodec {

/// Bytes of a text in a description.
inline constexpr std::size_t kMaxMetadataText = std::size_t{1} << 20;

/// corrupt unless it is UTF-8 of at most `most` bytes.
[[nodiscard]] std::string read_text(ByteReader& reader, std::size_t most);
void write_metadata(const Metadata& metadata, ByteWriter& writer);
void read_metadata(ByteReader& reader, Metadata& metadata, std::size_t most = kMaxMetadataText);

/// Entries that a metadata entry may hold, and bytes of its metadata.
inline constexpr std::size_t kMaxPackedEntries = std::size_t{1} << 18;
inline constexpr std::uint64_t kMaxPackedMetadata = std::uint64_t{64} << 20;
/// Most bytes of a metadata entry's fields before the packed bytes.
inline constexpr std::size_t kPackedHead = 1 + kMaxVarint;

/// The first fields of a metadata entry's body.
struct PackedMetadata {
  std::uint8_t texture_id = 0;
  std::uint64_t bytes = 0;  ///< of the metadata, unpacked
  std::size_t head = 0;     ///< bytes of these fields
};
/// `start`: the first bytes of a body, up to kPackedHead. corrupt.
[[nodiscard]] Result<PackedMetadata> read_packed_head(std::span<const std::byte> start);

/// Appends the body of a metadata entry. Errors: invalid_description if a text is not UTF-8;
/// limit_exceeded.
Status pack_metadata(std::uint8_t texture_id, const Metadata& metadata,
                     std::vector<std::byte>& body);
/// The inverse. Allocates what the body says only if its packed bytes make as much. corrupt.
[[nodiscard]] Result<Metadata> unpack_metadata(std::span<const std::byte> body);

}  // namespace gicodec
