// Kind 7, voxels (FORMAT.md, "Kinds").
#include <gicodec/voxels.h>

#include "base/guard.h"
#include "bitstream/description.h"
#include "kinds/made_volume.h"
#include "texture/texel.h"

#include <algorithm>
#include <cmath>

namespace gicodec {
namespace {

constexpr Format format_of(VoxelForm form) {
  return form == VoxelForm::halves ? Format::R16G16B16A16_SFLOAT : Format::E5B9G9R9_UFLOAT_PACK32;
}

/// Coarse bricks come first: all drawing needs them, and finer ones refine them.
float rank(std::span<const std::byte> block) {
  constexpr float kStep = 4;
  // Free slots come last.
  const auto mask = block.subspan(kBrickPlaceBytes);
  if (std::all_of(mask.begin(), mask.end(), [](std::byte b) { return b == std::byte{0}; }))
    return 0;
  return std::pow(kStep,
                  static_cast<float>(unpack_brick_place(block.first<kBrickPlaceBytes>()).level));
}

Status write(const VolumeDesc& volume, std::vector<std::byte>& out) {
  if (volume.kind != kKindVoxels || volume.groups.size() != 1 ||
      volume.groups.front().textures.size() != 2) {
    return Status::invalid_description;
  }
  const TextureDesc& light = volume.groups.front().textures.back().desc;
  const auto form = voxel_form(light.record);
  if (!form) return form.status();
  const auto made = voxel_volume(light.grid.x, light.block.y, *form);
  return write_made(volume, made, out, [&](ByteWriter& writer) {
    writer.varint(light.grid.x);
    writer.fixed(light.block.y);
    writer.fixed(static_cast<std::uint8_t>(*form));
  });
}

Result<VolumeDesc> read(std::span<const std::byte> description) {
  ByteReader reader(description);
  const auto bricks = static_cast<std::uint32_t>(reader.varint(kMaxBlocks));
  const auto side = reader.fixed<std::uint8_t>();
  const auto form = reader.fixed<std::uint8_t>();
  if (!reader.ok() || !reader.rest().empty() || form > 1) return Status::corrupt;
  return read_made(voxel_volume(bricks, side, static_cast<VoxelForm>(form)));
}

/// Every third bit from bit 0 on.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x001F00000000FFFF;
  x = (x | x << 16) & 0x001F0000FF0000FF;
  x = (x | x << 8) & 0x100F00F00F00F00F;
  x = (x | x << 4) & 0x10C30C30C30C30C3;
  return (x | x << 2) & 0x1249249249249249;
}
std::uint32_t gather_bits(std::uint64_t x) {
  x &= 0x1249249249249249;
  x = (x | x >> 2) & 0x10C30C30C30C30C3;
  x = (x | x >> 4) & 0x100F00F00F00F00F;
  x = (x | x >> 8) & 0x001F0000FF0000FF;
  x = (x | x >> 16) & 0x001F00000000FFFF;
  return static_cast<std::uint32_t>(x | x >> 32) & 0x001FFFFF;
}

}  // namespace

constinit const Kind kVoxels{kKindVoxels, "voxels", write, read, nullptr};

Result<VolumeDesc> voxel_volume(std::uint32_t bricks, std::uint8_t side, VoxelForm form) {
  constexpr std::uint8_t kSmall = 4, kLarge = 8;
  if ((side != kSmall && side != kLarge) || form > VoxelForm::halves) {
    return Status::invalid_description;
  }
  return guarded([&]() -> Result<VolumeDesc> {
    const auto width = static_cast<std::uint8_t>(kVoxelDirections * side);
    TextureDesc light = pool_texture(format_of(form), bricks, {width, side, side});
    light.presence = Presence::brick;
    light.model = Model::octree;
    const auto words = static_cast<std::uint8_t>(presence_bytes(light) / 4);
    VolumeDesc volume{kKindVoxels, {{}}};
    TextureGroup& group = volume.groups.front();
    group.textures = {
        {"bricks", pool_texture(Format::R32_UINT, bricks, {words, 1, 1}), Threshold::exact},
        {"light", light, Threshold::components, Preview::color}};
    group.bundled = true;
    group.presence = 0;
    group.rank = rank;
    if (const Status status = validate(volume); status != Status::ok) return status;
    return volume;
  });
}

Result<VoxelForm> voxel_form(const Record& record) noexcept {
  for (const VoxelForm form : {VoxelForm::shared_exponent, VoxelForm::halves}) {
    if (record == Record(format_of(form))) return form;
  }
  return Status::unsupported_format;
}

std::uint64_t morton_key(const std::array<std::uint32_t, 3>& at) noexcept {
  return spread_bits(at[0]) | spread_bits(at[1]) << 1 | spread_bits(at[2]) << 2;
}

std::array<std::uint32_t, 3> morton_cell(std::uint64_t key) noexcept {
  return {gather_bits(key), gather_bits(key >> 1), gather_bits(key >> 2)};
}

void pack_brick_place(const BrickPlace& place,
                      std::span<std::byte, kBrickPlaceBytes> out) noexcept {
  store(out.data(), morton_key(place.at) | std::uint64_t{place.level} << kBrickLevelShift);
}

BrickPlace unpack_brick_place(std::span<const std::byte, kBrickPlaceBytes> bytes) noexcept {
  constexpr std::uint64_t kKey = (std::uint64_t{1} << 54) - 1;
  const auto bits = load<std::uint64_t>(bytes.data());
  const std::uint64_t level = bits >> kBrickLevelShift;
  return {static_cast<std::uint8_t>(level < kMaxBrickLevel ? level : kMaxBrickLevel),
          morton_cell(bits & kKey)};
}

}  // namespace gicodec
