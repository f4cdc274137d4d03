#include "native/reference_raster.h"

#include "native/reference_continuous.h"

namespace gicodec::reference {

bool is_raster(const TextureDesc& desc) {
  return desc.model == Model::continuous &&
         std::ranges::any_of(desc.record.used(), [](const Component& component) {
           return component.type != ComponentType::opaque;
         });
}

bool may_be_raster(const TextureDesc& desc, const std::array<std::uint32_t, 3>& box) {
  const std::uint64_t volume = std::uint64_t{box[0]} * box[1] * box[2];
  return volume == 1 || volume * record_count(desc.block) * desc.record.count <= 1 << 20;
}

bool may_be_rows(const TextureDesc& desc, const std::array<std::uint32_t, 3>& box) {
  const std::uint64_t nx = std::uint64_t{box[0]} * desc.block.x,
                      ny = std::uint64_t{box[1]} * desc.block.y,
                      nz = std::uint64_t{box[2]} * desc.block.z;
  return may_be_raster(desc, box) &&
         (nx + 72) * 32 * ((ny + 31) / 32) * nz * desc.record.count <= 9 << 18;
}

}  // namespace gicodec::reference
