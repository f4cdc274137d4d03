#include "bitstream/container_metadata.h"

#include "base/compressor.h"

#include <algorithm>
#include <utility>

namespace gicodec {
namespace {

/// Bytes of the smallest entry.
constexpr std::size_t kMinEntry = 2;
constexpr int kLevel = 9;

}  // namespace

const std::string* find_metadata(const Metadata& metadata, std::string_view name) noexcept {
  const auto it = std::find_if(metadata.begin(), metadata.end(),
                               [name](const auto& entry) { return entry.first == name; });
  return it == metadata.end() ? nullptr : &it->second;
}

std::string read_text(ByteReader& reader, std::size_t most) {
  const auto text = reader.text(most);
  if (!is_utf8(text)) reader.fail(Status::corrupt);
  return std::string(text);
}

void write_metadata(const Metadata& metadata, ByteWriter& writer) {
  writer.varint(metadata.size());
  for (const auto& [name, value] : metadata) {
    writer.text(name);
    writer.text(value);
  }
}

void read_metadata(ByteReader& reader, Metadata& metadata, std::size_t most) {
  const auto count = reader.varint(std::min(reader.rest().size() / kMinEntry, kMaxPackedEntries));
  for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
    std::string name = read_text(reader, most);
    std::string value = read_text(reader, most);
    if (reader.ok()) metadata.emplace_back(std::move(name), std::move(value));
  }
}

Result<PackedMetadata> read_packed_head(std::span<const std::byte> start) {
  ByteReader reader(start);
  PackedMetadata head;
  head.texture_id = reader.fixed<std::uint8_t>();
  head.bytes = reader.varint(kMaxPackedMetadata);
  if (!reader.ok()) return Status::corrupt;
  head.head = start.size() - reader.rest().size();
  return head;
}

Status pack_metadata(std::uint8_t texture_id, const Metadata& metadata,
                     std::vector<std::byte>& body) {
  std::uint64_t bytes = kMaxVarint;
  for (const auto& [name, value] : metadata) {
    if (!is_utf8(name) || !is_utf8(value)) return Status::invalid_description;
    bytes += name.size() + value.size() + kMinEntry;
  }
  if (metadata.size() > kMaxPackedEntries || bytes > kMaxPackedMetadata) {
    return Status::limit_exceeded;
  }
  std::vector<std::byte> plain;
  ByteWriter writer(plain);
  write_metadata(metadata, writer);
  if (plain.size() > kMaxPackedMetadata) return Status::limit_exceeded;
  ByteWriter head(body);
  head.fixed(texture_id);
  head.varint(plain.size());
  auto compressor = Compressor::create(Compression::zstd, kLevel);
  return compressor ? compressor->compress(plain, body) : compressor.status();
}

Result<Metadata> unpack_metadata(std::span<const std::byte> body) {
  const auto head = read_packed_head(body);
  if (!head) return head.status();
  const auto packed = body.subspan(head->head);
  const auto size = static_cast<std::size_t>(head->bytes);
  Status status = check_compressed(Compression::zstd, packed, size);
  if (status != Status::ok) return status;
  auto decompressor = Decompressor::create(Compression::zstd);
  if (!decompressor) return decompressor.status();
  std::vector<std::byte> plain(size);
  status = decompressor->decompress(packed, plain);
  if (status != Status::ok) return status;
  ByteReader reader(plain);
  Metadata metadata;
  read_metadata(reader, metadata, kMaxPackedMetadata);
  if (!reader.ok() || !reader.rest().empty()) return Status::corrupt;
  return metadata;
}

}  // namespace gicodec
