#include "texture/guard_band.h"

#include "texture/octahedral_rule.h"

namespace gicodec {

void ring_by_rule(const TextureDesc& desc, const std::byte* core, std::span<std::byte> ring) {
  if (desc.border == 0) return;
  const std::size_t size = texel_bytes(desc);
  std::byte* to = ring.data();
  walk_rule(desc.core, [&](unsigned, unsigned, unsigned row, unsigned column) {
    std::memcpy(to, core + (std::size_t{row} * desc.core + column) * size, size);
    to += size;
  });
}

}  // namespace gicodec
