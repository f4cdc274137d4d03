#include "native/planes.h"

namespace gicodec::native {
PlaneLayout plane_layout(const FormatInfo& format) noexcept {
  PlaneLayout layout;
  layout.texel_bytes = format.texel_bytes;
  layout.pairs = format.format == Format::R16G16_SFLOAT;
  const unsigned count = format.component_count;
  for (unsigned i = 0; i < count; ++i) {
    const unsigned c = count >= 3 && i < 2 ? 1 - i : i;
    const Component& component = format.components[c];
    const auto byte = static_cast<std::uint8_t>(component.offset / 32 * 4);
    const auto shift = static_cast<std::uint8_t>(component.offset % 32);
    if (component.bits > 16) {
      layout.plane[layout.planes++] = {byte, static_cast<std::uint8_t>(shift + 16), 16};
      layout.plane[layout.planes++] = {byte, shift, 16};
    } else {
      layout.plane[layout.planes++] = {byte, shift, component.bits};
    }
  }
  return layout;
}

}  // namespace gicodec::native
