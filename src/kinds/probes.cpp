// Kind 1, probes (FORMAT.md, "Kinds").
#include <gicodec/probes.h>

#include "base/guard.h"
#include "bitstream/description.h"
#include "kinds/made_volume.h"

#include <string>
#include <utility>

namespace gicodec {
namespace {

Preview preview_of(const Record& record) {
  return record.count >= 3 ? Preview::color : Preview::distance;
}

Status append(const VolumeDesc& volume, std::vector<std::byte>& out) {
  if (const Status status = validate(volume); status != Status::ok) return status;
  if (volume.kind != kKindProbes || volume.groups.size() != 1) return Status::invalid_description;
  const auto& textures = volume.groups.front().textures;
  const Grid& grid = textures.front().desc.grid;
  ByteWriter writer(out);
  write_grid(grid, writer);
  writer.varint(textures.size());
  for (const NamedTexture& texture : textures) {
    const TextureDesc& desc = texture.desc;
    TextureDesc same = probe_texture(desc.record, grid, desc.block.x, desc.guard_band);
    same.layout = desc.layout;
    if (!(same == desc)) return Status::invalid_description;
    writer.text(texture.name);
    write_record(desc.record, writer);
    writer.fixed(desc.block.x);
    writer.fixed(desc.guard_band);
  }
  return Status::ok;
}

Result<VolumeDesc> parse(std::span<const std::byte> description) {
  ByteReader reader(description);
  const Grid grid = read_grid(reader, kMaxGridSide);
  const auto count = reader.varint(kMaxVolumeTextures);
  std::vector<NamedTexture> textures;
  for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
    std::string name(reader.text(kMaxName));
    const Record record = read_record(reader);
    const auto core = reader.fixed<std::uint8_t>();
    const auto guard_band = reader.fixed<std::uint8_t>();
    textures.push_back({std::move(name), probe_texture(record, grid, core, guard_band),
                        Threshold::components, preview_of(record)});
  }
  if (!reader.ok()) {
    return reader.status() == Status::truncated ? Status::corrupt : reader.status();
  }
  if (!reader.rest().empty()) return Status::corrupt;
  auto volume = probe_volume(textures);
  return read_made(std::move(volume));
}

Status write(const VolumeDesc& volume, std::vector<std::byte>& out) {
  return guarded([&] { return append(volume, out); });
}

Result<VolumeDesc> read(std::span<const std::byte> description) {
  return guarded([&] { return parse(description); });
}

}  // namespace

constinit const Kind kProbes{kKindProbes, "probes", write, read, nullptr};

Result<VolumeDesc> probe_volume(std::span<const NamedTexture> textures) {
  return guarded([&]() -> Result<VolumeDesc> {
    VolumeDesc volume{kKindProbes, {{}}};
    auto& own = volume.groups.front().textures;
    own.assign(textures.begin(), textures.end());
    for (NamedTexture& texture : own) texture.preview = preview_of(texture.desc.record);
    std::vector<std::byte> unused;
    if (const Status status = append(volume, unused); status != Status::ok) return status;
    return volume;
  });
}

}  // namespace gicodec
