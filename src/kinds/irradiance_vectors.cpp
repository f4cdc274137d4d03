// Kind 2, irradiance vectors (FORMAT.md, "Kinds").
#include <gicodec/irradiance_vectors.h>

#include "base/guard.h"
#include "bitstream/description.h"
#include "kinds/made_volume.h"

namespace gicodec {
namespace {

Status write(const VolumeDesc& volume, std::vector<std::byte>& out) {
  if (volume.kind != kKindIrradianceVectors || volume.groups.size() != 1 ||
      volume.groups.front().textures.size() != 1) {
    return Status::invalid_description;
  }
  const TextureDesc& vectors = volume.groups.front().textures.front().desc;
  const bool floats = vectors.record == colored_direction(true);
  const auto made = irradiance_vector_volume(vectors.grid, floats);
  return write_made(volume, made, out, [&](ByteWriter& writer) {
    write_grid(vectors.grid, writer);
    writer.fixed(static_cast<std::uint8_t>(floats ? 1 : 0));
  });
}

Result<VolumeDesc> read(std::span<const std::byte> description) {
  ByteReader reader(description);
  const Grid grid = read_grid(reader, kMaxGridSide);
  const auto floats = reader.fixed<std::uint8_t>();
  if (!reader.ok() || !reader.rest().empty() || floats > 1) return Status::corrupt;
  return read_made(irradiance_vector_volume(grid, floats == 1));
}

}  // namespace

constinit const Kind kIrradianceVectors{kKindIrradianceVectors, "irradiance_vectors", write, read,
                                        nullptr};

Result<VolumeDesc> irradiance_vector_volume(Grid grid, bool floats) {
  return guarded([&]() -> Result<VolumeDesc> {
    TextureDesc vectors;
    vectors.record = colored_direction(floats);
    vectors.grid = grid;
    vectors.block = {6, 1, 1};
    vectors.model = Model::hemispheres;
    vectors.layout = Tiling::blocks;
    VolumeDesc volume{kKindIrradianceVectors, {{}}};
    volume.groups.front().textures = {{"vectors", vectors, Threshold::components, Preview::color}};
    if (const Status status = validate(volume); status != Status::ok) return status;
    return volume;
  });
}

}  // namespace gicodec
