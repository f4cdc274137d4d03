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
      layout.plane[layout.planes++] = {byte, static_cast<std::uint8_t>(shift + 16),
                                       static_cast<std::uint8_t>(component.bits - 16)};
      layout.plane[layout.planes++] = {byte, shift, 16};
    } else {
      layout.plane[layout.planes++] = {byte, shift, component.bits};
    }
  }
  return layout;
}

Status check_texture(const TextureDesc& desc) noexcept {
  if (desc.presence != Presence::all || record_count(desc.block) > kMaxRecords) {
    return Status::unsupported_shape;
  }
  unsigned planes = 0;
  for (const Component& component : desc.record.used()) planes += component.bits > 16 ? 2 : 1;
  return planes <= kMaxPlanes ? Status::ok : Status::unsupported_format;
}

}  // namespace gicodec::native
