// A container's description: volumes, textures and metadata.
#include "base/bytes.h"
#include "base/float_bits.h"
#include "base/guard.h"
#include "bitstream/container_format.h"
#include "bitstream/container_metadata.h"
#include "bitstream/description.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace gicodec {
namespace {

constexpr std::uint64_t kMaxFoldedScroll = std::uint64_t{2} * kMaxScroll;

void write_real(float value, ByteWriter& writer) {
  writer.bytes(std::as_bytes(std::span(&value, 1)));
}

float read_real(ByteReader& reader) { return float_of(reader.fixed<std::uint32_t>()); }

void write_geometry(const VolumeGeometry& geometry, ByteWriter& writer) {
  for (const float along : geometry.origin) write_real(along, writer);
  for (const float along : geometry.spacing) write_real(along, writer);
  for (const std::int32_t cells : geometry.scroll) {
    const std::int64_t wide = cells;
    writer.varint(static_cast<std::uint64_t>(wide < 0 ? -2 * wide - 1 : 2 * wide));
  }
}

VolumeGeometry read_geometry(ByteReader& reader) {
  VolumeGeometry geometry;
  for (float& along : geometry.origin) along = read_real(reader);
  for (float& along : geometry.spacing) along = read_real(reader);
  for (std::int32_t& cells : geometry.scroll) {
    const auto folded = static_cast<std::int32_t>(reader.varint(kMaxFoldedScroll));
    cells = folded % 2 == 0 ? folded / 2 : -(folded / 2) - 1;
  }
  return geometry;
}

void write_texture_entry(const TextureEntry& texture, ByteWriter& writer) {
  writer.text(texture.name);
  const Layout& layout = texture.desc.layout;
  writer.fixed(static_cast<std::uint8_t>(layout.tiling));
  writer.fixed(layout.pad_before);
  writer.fixed(layout.pad_after);
  write_grid(layout.slots, writer);
  write_real(texture.largest_error, writer);
  write_metadata(texture.metadata, writer);
}

TextureEntry read_texture_entry(ByteReader& reader) {
  TextureEntry texture;
  texture.name = read_text(reader, kMaxName);
  Layout& layout = texture.desc.layout;
  const auto tiling = reader.fixed<std::uint8_t>();
  layout.tiling = static_cast<Tiling>(tiling);
  layout.pad_before = reader.fixed<std::uint8_t>();
  layout.pad_after = reader.fixed<std::uint8_t>();
  layout.slots = read_grid(reader, kMaxBlocks);
  texture.largest_error = read_real(reader);
  read_metadata(reader, texture.metadata);
  const Grid& slots = layout.slots;
  const bool stands = slots == Grid{} || (slots.x != 0 && slots.y != 0 && slots.z != 0);
  // The comparison refuses NaN.
  const bool error = texture.largest_error >= 0 && !std::signbit(texture.largest_error);
  if (texture.name.empty() || !stands || tiling >= kTilingCount ||
      layout.pad_before > kMaxPadding || layout.pad_after > kMaxPadding || !error) {
    reader.fail(Status::corrupt);
  }
  return texture;
}

bool names_unique(std::span<const TextureEntry> textures) {
  for (auto it = textures.begin(); it != textures.end(); ++it) {
    const auto same = [&](const TextureEntry& other) { return other.name == it->name; };
    if (std::any_of(textures.begin(), it, same)) return false;
  }
  return true;
}

/// Fills in `desc` of a volume and its textures from the kind's description, if the kind is known.
Status resolve(VolumeEntry& volume, std::span<TextureEntry> textures, const DecodeLimits& limits,
               std::span<const Kind* const> kinds) {
  if (find_kind(volume.kind, kinds) == nullptr) {
    if (!volume.geometry) return Status::ok;
    VolumeGeometry anywhere = *volume.geometry;
    anywhere.grid = {1, 1, 1};
    return validate(anywhere) == Status::ok ? Status::ok : Status::corrupt;
  }
  std::vector<TextureLayout> layouts;
  for (const TextureEntry& texture : textures)
    layouts.push_back({texture.name, texture.desc.layout});
  auto desc = read_volume_desc(volume.kind, volume.description, layouts, kinds);
  if (!desc) return desc.status();
  auto entry = textures.begin();
  for (const NamedTexture* texture : textures_of(*desc)) {
    const TextureDesc& own = (entry++)->desc = texture->desc;
    const TextureDesc largest = volume.region.x == 0 ? own : region_texture(own, volume.region, 0);
    if (texture_bytes(largest) > limits.max_texture_bytes) return Status::limit_exceeded;
  }
  if (volume.geometry) {
    volume.geometry->grid = desc->groups.front().textures.front().desc.grid;
    if (validate(*volume.geometry) != Status::ok) return Status::corrupt;
  }
  volume.desc = *std::move(desc);
  return Status::ok;
}

Status read_volume(ByteReader& reader, const DecodeLimits& limits,
                   std::span<const Kind* const> kinds, ContainerDescription& description) {
  VolumeEntry volume;
  volume.name = read_text(reader, kMaxName);
  volume.kind = reader.fixed<std::uint8_t>();
  const auto said = reader.bytes(static_cast<std::size_t>(reader.varint(kMaxKindDescription)));
  volume.description.assign(said.begin(), said.end());
  const auto placed = reader.fixed<std::uint8_t>();
  if (placed == 1) volume.geometry = read_geometry(reader);
  const Grid& region = volume.region = read_grid(reader, kMaxBlocks);
  const bool whole = region == Grid{};
  const bool cut = region.x != 0 && region.y != 0 && region.z != 0;
  volume.textures = static_cast<std::uint32_t>(reader.varint(kMaxVolumeTextures));
  if (!reader.ok()) return reader.status();
  if (volume.kind == 0 || placed > 1 || (!whole && !cut) || volume.textures == 0) {
    return Status::corrupt;
  }
  auto& textures = description.textures;
  volume.first_texture = static_cast<std::uint32_t>(textures.size());
  const std::size_t total = textures.size() + volume.textures;
  if (total > kMaxTextures) return Status::corrupt;
  if (total > limits.max_textures) return Status::limit_exceeded;
  while (textures.size() < total && reader.ok()) {
    textures.push_back(read_texture_entry(reader));
    textures.back().volume = static_cast<std::uint32_t>(description.volumes.size());
  }
  read_metadata(reader, volume.metadata);
  if (!reader.ok()) return reader.status();
  const auto own = std::span(textures).subspan(volume.first_texture);
  if (!names_unique(own)) return Status::corrupt;
  const Status status = resolve(volume, own, limits, kinds);
  if (status == Status::ok) description.volumes.push_back(std::move(volume));
  return status;
}

/// True if the description reads back as given: its bytes cannot hold every field. Volumes of
/// unknown kinds are not compared.
bool agree(const ContainerDescription& read, const ContainerDescription& given) {
  for (std::size_t i = 0; i < read.textures.size(); ++i) {
    if (is_known(read.textures[i]) && !(read.textures[i].desc == given.textures[i].desc)) {
      return false;
    }
  }
  for (std::size_t i = 0; i < read.volumes.size(); ++i) {
    const VolumeEntry& volume = read.volumes[i];
    if (!volume.desc.groups.empty() && volume.geometry != given.volumes[i].geometry) return false;
  }
  return true;
}

}  // namespace

Status add_volume(ContainerDescription& description, std::string name, const VolumeDesc& volume,
                  std::span<const Kind* const> kinds) {
  return guarded([&]() -> Status {
    VolumeEntry entry;
    if (const Status status = write_volume_desc(volume, kinds, entry.description);
        status != Status::ok) {
      return status;
    }
    entry.name = std::move(name);
    entry.kind = volume.kind;
    entry.desc = volume;
    entry.first_texture = static_cast<std::uint32_t>(description.textures.size());
    std::vector<TextureEntry> textures;
    const auto place = static_cast<std::uint32_t>(description.volumes.size());
    for (const NamedTexture* named : textures_of(volume)) {
      textures.push_back({named->name, named->desc, place, 0, {}});
    }
    entry.textures = static_cast<std::uint32_t>(textures.size());
    description.textures.reserve(description.textures.size() + textures.size());
    description.volumes.reserve(description.volumes.size() + 1);
    std::move(textures.begin(), textures.end(), std::back_inserter(description.textures));
    description.volumes.push_back(std::move(entry));
    return Status::ok;
  });
}

Status write_description(const ContainerDescription& description,
                         std::span<const Kind* const> kinds, std::vector<std::byte>& body) {
  body.clear();
  ByteWriter writer(body);
  writer.fixed(description.epoch);
  writer.text(description.scene.name);
  writer.fixed(description.scene.geometry);
  writer.varint(description.volumes.size());
  std::size_t next = 0;
  for (std::size_t v = 0; v < description.volumes.size(); ++v) {
    const VolumeEntry& volume = description.volumes[v];
    if (volume.first_texture != next || volume.textures > description.textures.size() - next) {
      return Status::invalid_description;
    }
    writer.text(volume.name);
    writer.fixed(volume.kind);
    writer.varint(volume.description.size());
    writer.bytes(volume.description);
    writer.fixed(static_cast<std::uint8_t>(volume.geometry ? 1 : 0));
    if (volume.geometry) write_geometry(*volume.geometry, writer);
    write_grid(volume.region, writer);
    writer.varint(volume.textures);
    for (const std::size_t end = next + volume.textures; next < end; ++next) {
      if (description.textures[next].volume != v) return Status::invalid_description;
      write_texture_entry(description.textures[next], writer);
    }
    write_metadata(volume.metadata, writer);
  }
  write_metadata(description.metadata, writer);
  if (next != description.textures.size()) return Status::invalid_description;

  DecodeLimits unlimited;
  unlimited.max_texture_bytes = std::numeric_limits<std::uint64_t>::max();
  ContainerDescription read;
  const Status status = read_description(body, unlimited, kinds, read);
  if (status == Status::out_of_memory) return status;
  return status == Status::ok && agree(read, description) ? Status::ok
                                                          : Status::invalid_description;
}

Status read_description(std::span<const std::byte> body, const DecodeLimits& limits,
                        std::span<const Kind* const> kinds, ContainerDescription& description) {
  ByteReader reader(body);
  const auto run = [&]() -> Status {
    description.epoch = reader.fixed<std::uint64_t>();
    description.scene.name = read_text(reader, kMaxName);
    description.scene.geometry = reader.fixed<std::uint64_t>();
    const auto count = reader.varint(kMaxVolumesOfFile);
    if (reader.ok() && count == 0) return Status::corrupt;
    for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
      const Status status = read_volume(reader, limits, kinds, description);
      if (status != Status::ok) return status;
    }
    read_metadata(reader, description.metadata);
    if (!reader.ok()) return reader.status();
    return reader.rest().empty() ? Status::ok : Status::corrupt;
  };
  // The entry's size is known, so a body that ends too early is corrupt.
  const Status status = run();
  return status == Status::truncated ? Status::corrupt : status;
}

std::vector<TextureRegion> parts_in_box(const ContainerDescription& description,
                                        std::uint32_t volume, const Grid& first, const Grid& last) {
  std::vector<TextureRegion> parts;
  if (volume >= description.volumes.size()) return parts;
  const VolumeEntry& entry = description.volumes[volume];
  for (std::uint32_t i = 0; i < entry.textures; ++i) {
    const auto id = static_cast<std::uint8_t>(entry.first_texture + i);
    const TextureDesc& desc = description.textures[id].desc;
    if (entry.region == Grid{} || !is_known(description.textures[id])) {
      parts.push_back({id});
      continue;
    }
    const bool boxed = desc.space == Space::grid &&
                       desc.grid == description.textures[entry.first_texture].desc.grid;
    const RegionGrid cut = regions_of(desc, entry.region);
    for (std::uint32_t region = 0; region < cut.regions(); ++region) {
      const Grid at = cut.first_of(region), size = cut.grid_of(region);
      const auto meets = [](std::uint32_t begin, std::uint32_t count, std::uint32_t from,
                            std::uint32_t to) { return begin <= to && begin + count > from; };
      if (!boxed || (meets(at.x, size.x, first.x, last.x) && meets(at.y, size.y, first.y, last.y) &&
                     meets(at.z, size.z, first.z, last.z))) {
        parts.push_back({id, region});
      }
    }
  }
  return parts;
}

std::optional<std::uint8_t> presence_texture(const ContainerDescription& description,
                                             std::uint8_t texture) noexcept {
  const TextureEntry& entry = description.textures[texture];
  if (entry.desc.presence == Presence::all) return std::nullopt;
  const VolumeEntry& volume = description.volumes[entry.volume];
  const auto own = static_cast<std::uint8_t>(texture - volume.first_texture);
  const auto [group, first] = group_of(volume.desc, own);
  return static_cast<std::uint8_t>(volume.first_texture + first + group->presence);
}

}  // namespace gicodec
