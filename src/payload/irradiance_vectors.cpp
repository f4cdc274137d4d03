// Kind 2, irradiance vectors (FORMAT.md, "Kinds").
#include <gicodec/irradiance_vectors.h>

#include "base/guard.h"
#include "bitstream/description.h"

namespace gicodec {
namespace {

constexpr BlockShape kHemispheres{6, 1, 1};

TextureDesc texture(Format format, Grid grid) {
  TextureDesc desc;
  desc.record = format;
  desc.grid = grid;
  desc.block = kHemispheres;
  desc.layout = Tiling::blocks;
  return desc;
}

Status write(const VolumeDesc& volume, std::vector<std::byte>& out) {
  if (volume.kind != kKindIrradianceVectors || volume.sets.size() != 1 ||
      volume.sets.front().textures.size() != 2) {
    return Status::invalid_description;
  }
  const TextureDesc& direction = volume.sets.front().textures.front().desc;
  const bool floats = direction.record.format == Format::R32G32B32_SFLOAT;
  const auto same = irradiance_vector_volume(direction.grid, floats);
  if (!same) return same.status();
  if (!same_but_layout(*same, volume)) return Status::invalid_description;
  if (const Status status = validate(volume); status != Status::ok) return status;
  return guarded([&]() -> Status {
    ByteWriter writer(out);
    write_grid(direction.grid, writer);
    writer.fixed(static_cast<std::uint8_t>(floats ? 1 : 0));
    return Status::ok;
  });
}

Result<VolumeDesc> read(std::span<const std::byte> description) {
  ByteReader reader(description);
  const Grid grid = read_grid(reader, kMaxGridSide);
  const auto floats = reader.fixed<std::uint8_t>();
  if (!reader.ok() || !reader.rest().empty() || floats > 1) return Status::corrupt;
  auto volume = irradiance_vector_volume(grid, floats == 1);
  if (!volume && volume.status() != Status::out_of_memory) return Status::corrupt;
  return volume;
}

}  // namespace

extern const Kind kIrradianceVectors;
constinit const Kind kIrradianceVectors{kKindIrradianceVectors, "irradiance_vectors", write, read,
                                        nullptr};

Result<VolumeDesc> irradiance_vector_volume(Grid grid, bool floats) {
  return guarded([&]() -> Result<VolumeDesc> {
    const Format direction = floats ? Format::R32G32B32_SFLOAT : Format::R8G8B8_SNORM;
    const Format color = floats ? Format::R32G32B32_SFLOAT : Format::E5B9G9R9_UFLOAT_PACK32;
    VolumeDesc volume{kKindIrradianceVectors, {{}}};
    BlockSet& set = volume.sets.front();
    set.together = true;
    set.textures = {
        {"direction", texture(direction, grid), Threshold::components, Preview::direction},
        {"color", texture(color, grid), Threshold::components, Preview::color}};
    if (const Status status = validate(volume); status != Status::ok) return status;
    return volume;
  });
}

}  // namespace gicodec
