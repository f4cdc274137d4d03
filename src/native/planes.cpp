#include "native/planes.h"

namespace gicodec::native {
PlaneLayout plane_layout(const TextureDesc& desc) noexcept {
  const Record& record = desc.record;
  PlaneLayout layout;
  layout.texel_bytes = record.bytes;
  layout.pairs = record.format == Format::R16G16_SFLOAT && desc.presence == Presence::all;
  const unsigned count = record.count;
  for (unsigned i = 0; i < count; ++i) {
    const unsigned c = count >= 3 && i < 2 ? 1 - i : i;
    const Component& component = record.components[c];
    const auto byte = static_cast<std::uint8_t>(component.offset / 32 * 4);
    const auto shift = static_cast<std::uint8_t>(component.offset % 32);
    if (component.bits > 16) {
      layout.plane[layout.planes++] = {byte, static_cast<std::uint8_t>(shift + 16),
                                       static_cast<std::uint8_t>(component.bits - 16)};
      layout.plane[layout.planes++] = {byte, shift, 16};
    } else {
      layout.plane[layout.planes++] = {byte, shift, component.bits};
    }
  }
  return layout;
}

}  // namespace gicodec::native
