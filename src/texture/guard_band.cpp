#include "texture/guard_band.h"

#include "texture/shape.h"

namespace gicodec {

void ring_by_rule(const TextureDesc& desc, const std::byte* core, std::span<std::byte> ring) {
  if (desc.border == 0) return;
  with_shape(desc, [&](auto shape) {
    using Texel = typename decltype(shape)::Texel;
    std::byte* to = ring.data();
    const std::size_t row_bytes = (shape.core() + 2) * sizeof(Texel);
    apply_rule(
        shape, core, shape.core() * sizeof(Texel),
        [&](unsigned, const Texel* row) {
          std::memcpy(to, row, row_bytes);
          to += row_bytes;
        },
        [&](unsigned, Texel left, Texel right) {
          store(to, left);
          store(to + sizeof(Texel), right);
          to += 2 * sizeof(Texel);
        });
  });
}

}  // namespace gicodec
