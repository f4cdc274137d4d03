#include "bitstream/container_format.h"

#include "base/bytes.h"

#include <algorithm>
#include <limits>

namespace gicodec {
namespace {

constexpr std::uint64_t kMaxText = std::uint64_t{1} << 20;
constexpr std::uint8_t kIndexKeyframe = 0x01;
/// An entry of the index takes at least four bytes, one of the metadata at least two.
constexpr std::size_t kMinIndexEntry = 4;
constexpr std::size_t kMinMetadataEntry = 2;

bool is_text(std::string_view text, std::uint64_t most) {
  return text.size() <= most && is_utf8(text);
}

bool texts_fit(const Metadata& metadata) {
  return std::ranges::all_of(metadata, [](const auto& entry) {
    return is_text(entry.first, kMaxText) && is_text(entry.second, kMaxText);
  });
}

std::string_view read_text(ByteReader& reader, std::uint64_t most) {
  const auto text = reader.text(most);
  if (!is_utf8(text)) reader.fail(Status::corrupt);
  return text;
}

void write_metadata(const Metadata& metadata, ByteWriter& writer) {
  writer.varint(metadata.size());
  for (const auto& [name, value] : metadata) {
    writer.text(name);
    writer.text(value);
  }
}

void read_metadata(ByteReader& reader, Metadata& metadata) {
  const auto count = reader.varint(reader.rest().size() / kMinMetadataEntry);
  for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
    const auto name = read_text(reader, kMaxText);
    const auto value = read_text(reader, kMaxText);
    if (reader.ok()) metadata.emplace_back(name, value);
  }
}

bool names_unique(const std::vector<TextureEntry>& textures) {
  for (auto it = textures.begin(); it != textures.end(); ++it) {
    const auto same = [&](const TextureEntry& other) { return other.name == it->name; };
    if (std::any_of(textures.begin(), it, same)) return false;
  }
  return true;
}

}  // namespace

bool is_utf8(std::string_view text) noexcept {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    if (lead < 0x80) continue;
    const unsigned more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : 1;
    if (lead < 0xC2 || lead > 0xF4 || text.size() - i < more) return false;
    // By the byte that follows a form may be overlong, a surrogate or too large.
    unsigned low = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
    unsigned high = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
    for (unsigned k = 0; k < more; ++k, low = 0x80, high = 0xBF) {
      const auto next = static_cast<unsigned char>(text[i++]);
      if (next < low || next > high) return false;
    }
  }
  return true;
}

const std::string* find_metadata(const Metadata& metadata, std::string_view name) noexcept {
  const auto it = std::ranges::find(
      metadata, name, [](const auto& entry) -> std::string_view { return entry.first; });
  return it == metadata.end() ? nullptr : &it->second;
}

Status write_description(const ContainerDescription& description, std::vector<std::byte>& out) {
  const auto& textures = description.textures;
  if (textures.empty() || textures.size() > kMaxTextures || !names_unique(textures) ||
      !texts_fit(description.metadata)) {
    return Status::invalid_argument;
  }
  ByteWriter writer(out);
  writer.varint(textures.size());
  for (const auto& texture : textures) {
    if (!is_text(texture.name, kMaxNameBytes) || !texts_fit(texture.metadata)) {
      return Status::invalid_argument;
    }
    const auto& desc = texture.desc;
    if (const Status status = validate(desc); status != Status::ok) return status;
    writer.text(texture.name);
    writer.fixed(static_cast<std::uint32_t>(desc.format));
    writer.varint(desc.grid.x);
    writer.varint(desc.grid.y);
    writer.varint(desc.grid.z);
    writer.fixed(static_cast<std::uint8_t>(desc.core));
    writer.fixed(static_cast<std::uint8_t>(desc.border));
    writer.fixed(static_cast<std::uint8_t>(desc.tiling));
    write_metadata(texture.metadata, writer);
  }
  write_metadata(description.metadata, writer);
  return Status::ok;
}

Status read_description(std::span<const std::byte> body, const DecodeLimits& limits,
                        ContainerDescription& description) {
  ByteReader reader(body);
  const auto count = reader.varint(kMaxTextures);
  if (reader.ok() && count == 0) return Status::corrupt;
  if (count > limits.max_textures) return Status::limit_exceeded;
  for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
    TextureEntry texture;
    auto& desc = texture.desc;
    texture.name = read_text(reader, kMaxNameBytes);
    desc.format = static_cast<Format>(reader.fixed<std::uint32_t>());
    desc.grid.x = static_cast<std::uint32_t>(reader.varint(kMaxGridSide));
    desc.grid.y = static_cast<std::uint32_t>(reader.varint(kMaxGridSide));
    desc.grid.z = static_cast<std::uint32_t>(reader.varint(kMaxGridSide));
    desc.core = reader.fixed<std::uint8_t>();
    desc.border = reader.fixed<std::uint8_t>();
    desc.tiling = static_cast<Tiling>(reader.fixed<std::uint8_t>());
    read_metadata(reader, texture.metadata);
    if (!reader.ok()) break;
    if (const Status status = validate(desc); status != Status::ok) {
      return status == Status::unsupported_format ? status : Status::corrupt;
    }
    if (texture_bytes(desc) > limits.max_texture_bytes) return Status::limit_exceeded;
    description.textures.push_back(std::move(texture));
  }
  read_metadata(reader, description.metadata);
  if (!reader.ok()) return reader.status() == Status::truncated ? Status::corrupt : reader.status();
  if (!reader.rest().empty() || !names_unique(description.textures)) return Status::corrupt;
  return Status::ok;
}

void write_index(std::span<const SeekEntry> index, std::vector<std::byte>& out) {
  ByteWriter writer(out);
  writer.varint(index.size());
  SeekEntry last;
  for (const auto& entry : index) {
    writer.varint(entry.frame - last.frame);
    writer.varint(entry.offset - last.offset);
    writer.fixed(entry.texture_id);
    writer.fixed(entry.keyframe ? kIndexKeyframe : std::uint8_t{0});
    last = entry;
  }
}

Status read_index_body(std::span<const std::byte> body, std::size_t textures, std::uint64_t begin,
                       std::uint64_t end, std::vector<SeekEntry>& index) {
  ByteReader reader(body);
  const auto count = reader.varint(body.size() / kMinIndexEntry);
  index.reserve(static_cast<std::size_t>(count));
  SeekEntry entry;
  for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
    entry.frame += reader.varint(std::numeric_limits<std::uint64_t>::max() - entry.frame);
    const std::uint64_t distance = reader.varint(end - entry.offset);
    entry.offset += distance;
    entry.texture_id = reader.fixed<std::uint8_t>();
    const auto flags = reader.fixed<std::uint8_t>();
    entry.keyframe = (flags & kIndexKeyframe) != 0;
    if (distance == 0 || entry.offset < begin || entry.offset >= end) return Status::corrupt;
    if (entry.texture_id >= textures || (flags & ~kIndexKeyframe) != 0) return Status::corrupt;
    index.push_back(entry);
  }
  return reader.ok() && reader.rest().empty() ? Status::ok : Status::corrupt;
}

}  // namespace gicodec
