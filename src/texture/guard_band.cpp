#include "texture/guard_band.h"

#include "texture/shape.h"

namespace gicodec {

void ring_by_rule(const TextureDesc& desc, const std::byte* core, std::span<std::byte> ring) {
  if (desc.border == 0) return;
  with_shape(desc, [&](auto shape) {
    using Texel = typename decltype(shape)::Texel;
    const std::size_t pitch = shape.core() * sizeof(Texel);
    std::byte* to = ring.data();
    walk_rule(shape, [&](unsigned, unsigned, unsigned row, unsigned column) {
      store(to, load<Texel>(core + row * pitch + column * sizeof(Texel)));
      to += sizeof(Texel);
    });
  });
}

}  // namespace gicodec
