#include "bitstream/description.h"

#include "base/checksum.h"

namespace gicodec {

void write_record(const Record& record, ByteWriter& writer) {
  writer.varint(static_cast<std::uint32_t>(record.format));
  if (record.format != Format::UNDEFINED) return;
  writer.fixed(record.bytes);
  writer.fixed(record.count);
  for (const Component& component : record.used()) {
    writer.text(component.name());
    writer.varint(component.offset);
    writer.fixed(component.bits);
    writer.fixed(static_cast<std::uint8_t>(component.type));
  }
}

Record read_record(ByteReader& reader) {
  const auto format = static_cast<Format>(reader.varint(UINT32_MAX));
  if (!reader.ok()) return {};
  if (format != Format::UNDEFINED) {
    if (find_format(format) == nullptr) reader.fail(Status::unsupported_format);
    return format;
  }
  Record record;
  record.bytes = reader.fixed<std::uint8_t>();
  record.count = reader.fixed<std::uint8_t>();
  if (reader.ok() && record.count > kMaxComponents) reader.fail(Status::corrupt);
  for (unsigned c = 0; c < record.count && reader.ok(); ++c) {
    const auto name = reader.text(Component::kMaxName);
    const auto offset = static_cast<std::uint16_t>(reader.varint(kMaxRecordBytes * 8));
    const auto bits = reader.fixed<std::uint8_t>();
    record.components[c] = {name, offset, bits,
                            static_cast<ComponentType>(reader.fixed<std::uint8_t>())};
  }
  if (reader.ok() && !is_valid(record)) reader.fail(Status::corrupt);
  return record;
}

void write_grid(const Grid& grid, ByteWriter& writer) {
  writer.varint(grid.x);
  writer.varint(grid.y);
  writer.varint(grid.z);
}

Grid read_grid(ByteReader& reader, std::uint32_t most) noexcept {
  Grid grid;
  for (auto* side : {&grid.x, &grid.y, &grid.z}) {
    *side = static_cast<std::uint32_t>(reader.varint(most));
  }
  return grid;
}

void write_texture(const TextureDesc& desc, ByteWriter& writer) {
  write_record(desc.record, writer);
  for (const auto side : {desc.block.x, desc.block.y, desc.block.z}) writer.fixed(side);
  writer.fixed(desc.guard_band);
  writer.fixed(static_cast<std::uint8_t>(desc.space));
  write_grid(desc.grid, writer);
  write_grid(desc.records, writer);
  writer.fixed(static_cast<std::uint8_t>(desc.presence));
  writer.fixed(static_cast<std::uint8_t>(desc.model));
}

TextureDesc read_texture(ByteReader& reader) {
  TextureDesc desc;
  desc.record = read_record(reader);
  for (auto* side : {&desc.block.x, &desc.block.y, &desc.block.z}) {
    *side = reader.fixed<std::uint8_t>();
  }
  desc.guard_band = reader.fixed<std::uint8_t>();
  desc.space = static_cast<Space>(reader.fixed<std::uint8_t>());
  desc.grid = read_grid(reader, kMaxBlocks);
  desc.records = read_grid(reader, kMaxGridSide * kMaxBlockSide);
  desc.presence = static_cast<Presence>(reader.fixed<std::uint8_t>());
  desc.model = static_cast<Model>(reader.fixed<std::uint8_t>());
  if (!reader.ok()) return desc;
  const Status status = validate(desc);
  if (status != Status::ok) reader.fail(status_of_read(status));
  return desc;
}

Status write_volume_desc(const VolumeDesc& volume, std::span<const Kind* const> kinds,
                         std::vector<std::byte>& out) {
  const Kind* const kind = find_kind(volume.kind, kinds);
  if (kind == nullptr) return Status::unknown_kind;
  std::vector<std::byte> description;
  const Status status = kind->write(volume, description);
  if (status != Status::ok && status != Status::end) return status;
  if (status == Status::end || description.size() > kMaxKindDescription) {
    return Status::invalid_description;
  }
  const auto back = kind->read(description);
  if (back.status() == Status::out_of_memory) return back.status();
  if (!back || !same_but_layout(*back, volume)) return Status::invalid_description;
  out.insert(out.end(), description.begin(), description.end());
  return Status::ok;
}

Result<VolumeDesc> read_volume_desc(std::uint8_t kind, std::span<const std::byte> description,
                                    std::span<const TextureLayout> layouts,
                                    std::span<const Kind* const> kinds) {
  const Kind* const known = find_kind(kind, kinds);
  if (known == nullptr) return Status::unknown_kind;
  auto volume = known->read(description);
  // A kind's Status::end would be taken for the end of the file or session.
  if (!volume) return volume.status() == Status::end ? Status::corrupt : volume.status();
  auto next = layouts.begin();
  for (TextureGroup& group : volume->groups) {
    for (NamedTexture& texture : group.textures) {
      if (next == layouts.end() || next->name != texture.name) return Status::corrupt;
      texture.desc.layout = (next++)->layout;
    }
  }
  const bool agrees = volume->kind == kind && next == layouts.end();
  if (!agrees) return Status::corrupt;
  if (const Status status = validate(*volume); status != Status::ok) return status_of_read(status);
  return volume;
}

std::pair<const TextureGroup*, std::uint8_t> group_of(const VolumeDesc& volume,
                                                      std::uint8_t texture) noexcept {
  std::uint8_t first = 0;
  auto group = volume.groups.begin();
  while (texture - first >= static_cast<int>(group->textures.size())) {
    first = static_cast<std::uint8_t>(first + group++->textures.size());
  }
  return {&*group, first};
}

std::uint32_t description_hash(const TextureDesc& desc) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  write_texture(desc, writer);
  return checksum(bytes);
}

}  // namespace gicodec
