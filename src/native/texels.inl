// A block of texels ↔ its planes: plain loops that compilers vectorise.

template <typename T>
GICODEC_INLINE T load_word(const std::uint8_t* p) {
  T v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
template <typename T>
GICODEC_INLINE void store_word(std::uint8_t* p, T v) {
  std::memcpy(p, &v, sizeof v);
}

void unpack(const PlaneLayout& layout, const std::uint8_t* in, std::size_t texels,
            std::uint16_t* __restrict planes) {
  if (layout.pairs) {
    for (std::size_t t = 0; t < texels; ++t) {
      const auto v = load_word<std::uint32_t>(in + 4 * t);
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
        planes[t] = static_cast<std::uint16_t>(load_word<std::uint32_t>(in + 4 * t) >> plane.shift & mask);
      }
    } else if (layout.texel_bytes == 2) {
      for (std::size_t t = 0; t < texels; ++t) planes[t] = load_word<std::uint16_t>(in + 2 * t);
    } else {
      const std::uint8_t* from = in + plane.byte;
      for (std::size_t t = 0; t < texels; ++t, from += layout.texel_bytes) {
        planes[t] = static_cast<std::uint16_t>(load_word<std::uint32_t>(from) >> plane.shift & mask);
      }
    }
  }
}

void pack(const PlaneLayout& layout, const std::uint16_t* planes, std::size_t texels,
          std::uint8_t* out) {
  if (layout.pairs) {
    for (std::size_t t = 0; t < texels; ++t) {
      const std::uint32_t m1 = planes[t];
      const std::uint32_t m2 = planes[texels + t] + 2 * m1;
      store_word(out + 4 * t, m1 | m2 << 16);
    }
    return;
  }
  if (layout.texel_bytes == 2) {
    for (std::size_t t = 0; t < texels; ++t) store_word(out + 2 * t, planes[t]);
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
      store_word(out + 4 * t, static_cast<std::uint32_t>(p[0][t]) << shift[0] |
                             static_cast<std::uint32_t>(p[1][t]) << shift[1] |
                             static_cast<std::uint32_t>(p[2][t]) << shift[2] |
                             static_cast<std::uint32_t>(p[3][t]) << shift[3]);
    }
    return;
  }
  std::memset(out, 0, texels * layout.texel_bytes);
  for (unsigned k = 0; k < layout.planes; ++k, planes += texels) {
    std::uint8_t* to = out + layout.plane[k].byte;
    for (std::size_t t = 0; t < texels; ++t, to += layout.texel_bytes) {
      store_word(to, load_word<std::uint32_t>(to) | static_cast<std::uint32_t>(planes[t]) << layout.plane[k].shift);
    }
  }
}
