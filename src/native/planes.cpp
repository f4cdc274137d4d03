#include "native/planes.h"

namespace gicodec::native {
PlaneLayout plane_layout(const Record& record) noexcept {
  PlaneLayout layout;
  layout.texel_bytes = record.bytes;
  layout.pairs = record.format == Format::R16G16_SFLOAT;
  const unsigned count = record.count;
  for (unsigned i = 0; i < count; ++i) {
    const unsigned c = count >= 3 && i < 2 ? 1 - i : i;
    const Component& component = record.components[c];
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

Status check_texture(const TextureDesc& desc) noexcept {
  const BlockShape& block = desc.block;
  if (block.x != block.y || block.z != 1 || desc.space != Space::grid || desc.records.x != 0 ||
      desc.presence != Presence::all || !(desc.prediction == kStacked)) {
    return Status::unsupported_shape;
  }
  unsigned planes = 0;
  for (const Component& component : desc.record.used()) {
    const bool known = component.bits == 2 || component.bits == 5 || component.bits == 32 ||
                       component.bits == 16 || (component.bits >= 8 && component.bits <= 11);
    if (!known) return Status::unsupported_format;
    planes += component.bits > 16 ? 2 : 1;
  }
  const bool words = desc.record.bytes % 4 == 0 || (desc.record.bytes == 2 && planes == 1);
  return words && planes <= kMaxPlanes ? Status::ok : Status::unsupported_format;
}

}  // namespace gicodec::native
