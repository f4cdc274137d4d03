#include "native/planes/planes.h"

#include <bit>

namespace gicodec::native {
PlaneLayout plane_layout(const TextureDesc& desc) noexcept {
  const Record& record = desc.record;
  PlaneLayout layout;
  layout.texel_bytes = record.bytes;
  layout.partial = desc.presence != Presence::all;
  layout.pairs = record.format == Format::R16G16_SFLOAT && desc.presence == Presence::all;
  layout.shared = record.format == Format::E5B9G9R9_UFLOAT_PACK32;
  const unsigned count = record.count;
  for (unsigned i = 0; i < count; ++i) {
    const unsigned c = count >= 3 && i < 2 ? 1 - i : i;
    const Component& component = record.components[c];
    const auto byte = static_cast<std::uint8_t>(component.offset / 32 * 4);
    const auto shift = static_cast<std::uint8_t>(component.offset % 32);
    if (component.bits > 16) {
      const auto high = static_cast<std::uint8_t>(component.bits - 16);
      layout.plane[layout.planes++] = {byte, static_cast<std::uint8_t>(shift + 16), high, high, 1};
      layout.low |= 1U << layout.planes;
      layout.plane[layout.planes++] = {byte, shift, 16, 16, 1};
    } else {
      layout.plane[layout.planes++] = {byte, shift, component.bits, component.bits, 1};
    }
  }
  return layout;
}

bool valid_step(const PlaneLayout& layout, unsigned plane, unsigned step) noexcept {
  if (layout.pairs) return std::has_single_bit(step) && step < 1U << 16;
  return step >= 1 && step < 1U << layout.plane[plane].stored;
}

void set_step(PlaneLayout& layout, unsigned plane, unsigned step) noexcept {
  auto& p = layout.plane[plane];
  const unsigned largest = (1U << p.stored) - 1;
  p.step = static_cast<std::uint16_t>(step);
  if (!layout.pairs) {
    p.bits = static_cast<std::uint8_t>(std::bit_width((largest + step - 1) / step));
  }
  layout.stepped = layout.stepped || step > 1;
}

}  // namespace gicodec::native
