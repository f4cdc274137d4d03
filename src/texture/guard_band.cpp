#include "texture/guard_band.h"

#include "texture/octahedral_rule.h"

namespace gicodec {

void band_by_rule(const TextureDesc& desc, const std::byte* block, std::span<std::byte> band) {
  if (desc.guard_band == 0) return;
  const std::size_t size = desc.record.bytes;
  std::byte* to = band.data();
  walk_rule(desc.block.x, [&](unsigned, unsigned, unsigned row, unsigned column) {
    std::memcpy(to, block + (std::size_t{row} * desc.block.x + column) * size, size);
    to += size;
  });
}

}  // namespace gicodec
