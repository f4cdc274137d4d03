#include "native/planes.h"

#include <cstring>

namespace gicodec::native {
namespace {

template <typename T>
T load(const std::byte* p) noexcept {
  T v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
template <typename T>
void store(std::byte* p, T v) noexcept {
  std::memcpy(p, &v, sizeof v);
}

}  // namespace

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

void unpack(const PlaneLayout& layout, const std::byte* in, std::size_t texels,
            std::uint16_t* planes) noexcept {
  if (layout.pairs) {
    for (std::size_t t = 0; t < texels; ++t) {
      const auto v = load<std::uint32_t>(in + 4 * t);
      planes[t] = static_cast<std::uint16_t>(v);
      planes[texels + t] = static_cast<std::uint16_t>((v >> 16) - 2 * v);
    }
    return;
  }
  for (unsigned p = 0; p < layout.planes; ++p, planes += texels) {
    const auto plane = layout.plane[p];
    const std::uint32_t mask = (1U << plane.bits) - 1;
    if (layout.texel_bytes == 4) {
      for (std::size_t t = 0; t < texels; ++t) {
        planes[t] = static_cast<std::uint16_t>(load<std::uint32_t>(in + 4 * t) >> plane.shift & mask);
      }
    } else if (layout.texel_bytes == 2) {
      for (std::size_t t = 0; t < texels; ++t) planes[t] = load<std::uint16_t>(in + 2 * t);
    } else {
      const std::byte* from = in + plane.byte;
      for (std::size_t t = 0; t < texels; ++t, from += layout.texel_bytes) {
        planes[t] = static_cast<std::uint16_t>(load<std::uint32_t>(from) >> plane.shift & mask);
      }
    }
  }
}

void pack(const PlaneLayout& layout, const std::uint16_t* planes, std::size_t texels,
          std::byte* out) noexcept {
  if (layout.pairs) {
    for (std::size_t t = 0; t < texels; ++t) {
      const std::uint32_t m1 = planes[t];
      const std::uint32_t m2 = planes[texels + t] + 2 * m1;
      store(out + 4 * t, m1 | m2 << 16);
    }
    return;
  }
  if (layout.texel_bytes == 2) {
    for (std::size_t t = 0; t < texels; ++t) store(out + 2 * t, planes[t]);
    return;
  }
  if (layout.texel_bytes == 4) {
    const std::uint16_t* p[4];
    unsigned shift[4];
    for (unsigned k = 0; k < 4; ++k) {  // a missing plane repeats the first
      p[k] = planes + (k < layout.planes ? k : 0) * texels;
      shift[k] = layout.plane[k < layout.planes ? k : 0].shift;
    }
    for (std::size_t t = 0; t < texels; ++t) {
      store(out + 4 * t, static_cast<std::uint32_t>(p[0][t]) << shift[0] |
                             static_cast<std::uint32_t>(p[1][t]) << shift[1] |
                             static_cast<std::uint32_t>(p[2][t]) << shift[2] |
                             static_cast<std::uint32_t>(p[3][t]) << shift[3]);
    }
    return;
  }
  std::memset(out, 0, texels * layout.texel_bytes);
  for (unsigned k = 0; k < layout.planes; ++k, planes += texels) {
    std::byte* to = out + layout.plane[k].byte;
    for (std::size_t t = 0; t < texels; ++t, to += layout.texel_bytes) {
      store(to, load<std::uint32_t>(to) | static_cast<std::uint32_t>(planes[t]) << layout.plane[k].shift);
    }
  }
}

}  // namespace gicodec::native
