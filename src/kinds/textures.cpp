// Kind 3, textures (FORMAT.md, "Kinds").
#include <gicodec/textures.h>

#include "base/guard.h"
#include "bitstream/description.h"
#include "kinds/made_volume.h"

#include <algorithm>
#include <utility>

namespace gicodec {
namespace {

constexpr auto kLastPreview = static_cast<std::uint8_t>(Preview::direction);

bool is_plain(const TextureGroup& group) {
  return group.presence == TextureGroup::kNone && group.depends_on == TextureGroup::kNone &&
         group.rank == nullptr;
}

Status append(const VolumeDesc& volume, std::vector<std::byte>& out) {
  if (const Status status = validate(volume); status != Status::ok) return status;
  if (volume.kind != kKindTextures) return Status::invalid_description;
  ByteWriter writer(out);
  writer.varint(volume.groups.size());
  for (const TextureGroup& group : volume.groups) {
    if (!is_plain(group)) return Status::invalid_description;
    writer.fixed(static_cast<std::uint8_t>(group.bundled));
    writer.varint(group.textures.size());
    for (const NamedTexture& texture : group.textures) {
      if (texture.threshold > Threshold::exact || texture.preview > Preview::direction) {
        return Status::invalid_description;
      }
      writer.text(texture.name);
      write_texture(texture.desc, writer);
      writer.fixed(static_cast<std::uint8_t>(texture.threshold));
      writer.fixed(static_cast<std::uint8_t>(texture.preview));
    }
  }
  return Status::ok;
}

std::uint8_t choice(ByteReader& reader, std::uint8_t last) {
  const auto value = reader.fixed<std::uint8_t>();
  if (value > last) reader.fail(Status::corrupt);
  return value;
}

Result<VolumeDesc> parse(std::span<const std::byte> description) {
  ByteReader reader(description);
  VolumeDesc volume{kKindTextures, {}};
  const auto groups = reader.varint(kMaxGroups);
  for (std::uint64_t s = 0; s < groups && reader.ok(); ++s) {
    TextureGroup& group = volume.groups.emplace_back();
    group.bundled = choice(reader, 1) == 1;
    const auto textures = reader.varint(kMaxVolumeTextures);
    for (std::uint64_t t = 0; t < textures && reader.ok(); ++t) {
      NamedTexture texture;
      texture.name = reader.text(kMaxName);
      texture.desc = read_texture(reader);
      texture.threshold = static_cast<Threshold>(choice(reader, 1));
      texture.preview = static_cast<Preview>(choice(reader, kLastPreview));
      group.textures.push_back(std::move(texture));
    }
  }
  if (!reader.ok()) {
    return reader.status() == Status::truncated ? Status::corrupt : reader.status();
  }
  if (!reader.rest().empty()) return Status::corrupt;
  if (const Status status = validate(volume); status != Status::ok) return status_of_read(status);
  return volume;
}

Status write(const VolumeDesc& volume, std::vector<std::byte>& out) {
  return guarded([&] { return append(volume, out); });
}

Result<VolumeDesc> read(std::span<const std::byte> description) {
  return guarded([&] { return parse(description); });
}

/// Blocks of `side` along an axis, rounded up; 0 for a side of 0.
std::uint32_t blocks_along(std::uint32_t records, std::uint8_t side) {
  return side == 0 ? 0 : records / side + (records % side != 0 ? 1 : 0);
}

}  // namespace

constinit const Kind kTextures{kKindTextures, "textures", write, read, nullptr};

TextureDesc map_texture(const Record& record, Grid records, BlockShape block) noexcept {
  const auto most = [](std::uint8_t side, std::uint32_t of) {
    return static_cast<std::uint8_t>(std::min<std::uint32_t>(side, of));
  };
  TextureDesc desc;
  desc.record = record;
  desc.block = {most(block.x, records.x), most(block.y, records.y), most(block.z, records.z)};
  desc.grid = {blocks_along(records.x, desc.block.x), blocks_along(records.y, desc.block.y),
               blocks_along(records.z, desc.block.z)};
  const Grid whole{desc.grid.x * desc.block.x, desc.grid.y * desc.block.y,
                   desc.grid.z * desc.block.z};
  if (!(whole == records)) desc.records = records;
  desc.model = Model::continuous;
  desc.layout = Tiling::slices_xy_z;
  return desc;
}

TextureDesc brick_texture(const Record& record, std::uint32_t bricks, BlockShape brick,
                          Grid slots) noexcept {
  TextureDesc desc = pool_texture(record, bricks, brick);
  desc.layout = Tiling::slices_xy_z;
  desc.layout.slots = slots;
  return desc;
}

Result<VolumeDesc> texture_volume(std::span<const TextureGroup> groups) {
  return guarded([&]() -> Result<VolumeDesc> {
    VolumeDesc volume{kKindTextures, {groups.begin(), groups.end()}};
    std::vector<std::byte> unused;
    if (const Status status = append(volume, unused); status != Status::ok) return status;
    return volume;
  });
}

}  // namespace gicodec
