// Kind 4, irradiance maps (FORMAT.md, "Kinds").
#include <gicodec/irradiance_maps.h>
#include <gicodec/textures.h>

#include "base/guard.h"
#include "bitstream/description.h"
#include "kinds/record_parts.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gicodec {
namespace {

constexpr BlockShape kOne{1, 1, 1};
constexpr BlockShape kTile{kMapTile, kMapTile, 1};
constexpr std::uint32_t kBlockBases = kMapBaseBlock * kMapBaseBlock;

constexpr std::array<Format, 4> kFormats{
    Format::E5B9G9R9_UFLOAT_PACK32, Format::B10G11R11_UFLOAT_PACK32, Format::R16G16B16A16_SFLOAT,
    Format::A2B10G10R10_UNORM_PACK32};

/// Appends `count` components of `bits` bits, named by a letter and a number.
void append_components(Record& record, char letter, std::uint8_t count, std::uint8_t bits,
                       ComponentType kind) {
  for (std::uint8_t i = 0; i < count; ++i) {
    const char name[2] = {letter, static_cast<char>('0' + i)};
    record.components[record.count++] = {
        {name, 2}, static_cast<std::uint16_t>(8 * record.bytes), bits, kind};
    record.bytes = static_cast<std::uint8_t>(record.bytes + bits / 8);
  }
}

Record mask_record() {
  Record record;
  append_components(record, 'm', 8, 32, ComponentType::opaque);
  return record;
}

Record blend_record() {
  Record record;
  append_components(record, 'b', kMapBlends, 16, ComponentType::uint);
  append_components(record, 'w', kMapBlends, 8, ComponentType::uint);
  return record;
}

Record hash_record() {
  Record record;
  append_components(record, 'h', 2, 32, ComponentType::opaque);
  return record;
}

/// A texture of the map's tiles; the map may end within them.
TextureDesc tiled(const Record& record, const IrradianceMapDesc& desc) {
  TextureDesc map;
  map.record = record;
  map.block = kTile;
  map.grid = {(desc.width - 1) / kMapTile + 1, (desc.height - 1) / kMapTile + 1, 1};
  const bool whole = desc.width % kMapTile == 0 && desc.height % kMapTile == 0;
  if (!whole) map.records = {desc.width, desc.height, 1};
  map.model = Model::continuous;
  map.layout = Tiling::slices_xy_z;
  return map;
}

/// The bundled textures of masks and of the texels that they cover.
TextureGroup covered(const char* coverage, NamedTexture texels) {
  texels.desc.presence = Presence::mask;
  TextureDesc masks = texels.desc;
  masks.record = mask_record();
  masks.block = kOne;
  masks.records = {};
  masks.presence = Presence::all;
  TextureGroup group;
  group.textures = {{coverage, masks, Threshold::exact}, std::move(texels)};
  group.bundled = true;
  group.presence = 0;
  return group;
}

TextureGroup map_set(const IrradianceMapDesc& desc) {
  return covered("coverage",
                 {"irradiance", tiled(desc.format, desc), Threshold::components, Preview::color});
}

TextureGroup coefficient_set(const IrradianceMapDesc& desc) {
  const std::uint32_t blocks = (desc.bases - 1) / kBlockBases + 1;
  TextureGroup group;
  group.textures = {{"coefficients",
                     pool_texture(desc.format, blocks, {kMapBaseBlock, kMapBaseBlock, 1}),
                     Threshold::components, Preview::color}};
  return group;
}

TextureGroup blend_set(const IrradianceMapDesc& desc) {
  return covered("blend coverage", {"blend", tiled(blend_record(), desc), Threshold::exact});
}

TextureGroup parameterisation_set() {
  TextureGroup set;
  set.textures = {{"parameterisation", pool_texture(hash_record(), 1, kOne), Threshold::exact}};
  return set;
}

bool is_valid(const IrradianceMapDesc& desc) {
  const bool by_bases = desc.way == MapWay::bases;
  return desc.width >= 1 && desc.width <= kMaxMapSide && desc.height >= 1 &&
         desc.height <= kMaxMapSide && desc.way <= MapWay::bases &&
         std::find(kFormats.begin(), kFormats.end(), desc.format) != kFormats.end() &&
         (desc.bases >= 1) == by_bases && desc.bases <= kMaxMapBases;
}

VolumeDesc make(const IrradianceMapDesc& desc) {
  VolumeDesc volume{kKindIrradianceMaps, {}};
  if (desc.way == MapWay::bases) {
    volume.groups = {coefficient_set(desc), blend_set(desc)};
  } else {
    volume.groups = {map_set(desc)};
  }
  volume.groups.push_back(parameterisation_set());
  return volume;
}

/// The description that the textures suggest; the caller checks it by make().
IrradianceMapDesc guess(const VolumeDesc& volume) {
  IrradianceMapDesc desc;
  const auto texture = [&](std::size_t group, std::size_t place) -> TextureDesc {
    if (group >= volume.groups.size() || place >= volume.groups[group].textures.size()) return {};
    return volume.groups[group].textures[place].desc;
  };
  const auto size_by = [&](const TextureDesc& of) {
    const bool whole = of.records == Grid{};
    desc.width = whole ? of.grid.x * kMapTile : of.records.x;
    desc.height = whole ? of.grid.y * kMapTile : of.records.y;
  };
  if (volume.groups.size() == 2) {
    size_by(texture(0, 1));
    desc.format = texture(0, 1).record.format;
  } else {
    desc.way = MapWay::bases;
    size_by(texture(1, 1));
    desc.format = texture(0, 0).record.format;
    desc.bases = texture(0, 0).grid.x * kBlockBases;
  }
  return desc;
}

Status write(const VolumeDesc& volume, std::vector<std::byte>& out) {
  const auto desc = irradiance_map_desc(volume);
  if (!desc) return desc.status();
  return guarded([&]() -> Status {
    ByteWriter writer(out);
    writer.varint(desc->width);
    writer.varint(desc->height);
    writer.varint(static_cast<std::uint32_t>(desc->format));
    writer.fixed(static_cast<std::uint8_t>(desc->way));
    if (desc->way == MapWay::bases) writer.varint(desc->bases / kBlockBases);
    return Status::ok;
  });
}

Result<VolumeDesc> read(std::span<const std::byte> description) {
  ByteReader reader(description);
  IrradianceMapDesc desc;
  desc.width = static_cast<std::uint32_t>(reader.varint(kMaxMapSide));
  desc.height = static_cast<std::uint32_t>(reader.varint(kMaxMapSide));
  desc.format = static_cast<Format>(reader.varint(UINT32_MAX));
  desc.way = static_cast<MapWay>(reader.fixed<std::uint8_t>());
  if (desc.way == MapWay::bases) {
    desc.bases =
        static_cast<std::uint32_t>(reader.varint(kMaxMapBases / kBlockBases)) * kBlockBases;
  }
  if (!reader.ok() || !reader.rest().empty() || !is_valid(desc)) return Status::corrupt;
  return irradiance_map_volume(desc);
}

}  // namespace

constinit const Kind kIrradianceMaps{kKindIrradianceMaps, "irradiance_maps", write, read, nullptr};

Result<VolumeDesc> irradiance_map_volume(const IrradianceMapDesc& desc) {
  return guarded([&]() -> Result<VolumeDesc> {
    if (!is_valid(desc)) return Status::invalid_description;
    VolumeDesc volume = make(desc);
    if (const Status status = validate(volume); status != Status::ok) return status;
    return volume;
  });
}

Result<IrradianceMapDesc> irradiance_map_desc(const VolumeDesc& volume) {
  return guarded([&]() -> Result<IrradianceMapDesc> {
    const IrradianceMapDesc desc = guess(volume);
    if (volume.kind != kKindIrradianceMaps || !is_valid(desc) ||
        !same_but_layout(make(desc), volume)) {
      return Status::invalid_description;
    }
    return desc;
  });
}

}  // namespace gicodec
