// A block of texels ↔ its planes: plain loops that compilers vectorise.

#include "simd/memory.inl"

/// Texels of 32 bits by vectors, the rest one by one.
GICODEC_INLINE std::size_t unpack32(const PlaneLayout& layout, const std::uint8_t* in,
                                    std::size_t texels, std::uint16_t* planes) {
  std::size_t t = 0;
  for (; t + kLanes <= texels; t += kLanes) {
    const U32 v = load(reinterpret_cast<const std::uint32_t*>(in + 4 * t));
    if (layout.pairs) {
      const I16 m1 = narrow(bit_and(v, set32(0xFFFF)));
      store(planes + t, m1);
      store(planes + texels + t, sub(narrow(shift_right<16>(v)), add(m1, m1)));
      continue;
    }
    const I16 low = narrow(bit_and(v, set32(0xFFFF))), high = narrow(shift_right<16>(v));
    for (unsigned p = 0; p < layout.planes; ++p) {
      const auto plane = layout.plane[p];
      const unsigned shift = plane.shift;
      const I16 value = shift < 16
                            ? bit_or(shift_right_all(low, shift), shift_left_all(high, 16 - shift))
                            : shift_right_all(high, shift - 16);
      store(planes + p * texels + t, bit_and(value, set((1 << plane.stored) - 1)));
    }
  }
  return t;
}
GICODEC_INLINE std::size_t pack32(const PlaneLayout& layout, const std::uint16_t* planes,
                                  std::size_t texels, std::uint8_t* out) {
  std::size_t t = 0;
  for (; t + kLanes <= texels; t += kLanes) {
    U32 v = set32(0);
    if (layout.pairs) {
      const I16 m1 = load(planes + t);
      const I16 m2 = add(load(planes + texels + t), add(m1, m1));
      v = bit_or(widen(m1), shift_left<16>(widen(m2)));
    } else {
      I16 low = set(0), high = set(0);
      for (unsigned p = 0; p < layout.planes; ++p) {
        const I16 value = load(planes + p * texels + t);
        const unsigned shift = layout.plane[p].shift;
        low = bit_or(low, shift_left_all(value, shift));
        high = bit_or(high, shift < 16 ? shift_right_all(value, 16 - shift)
                                       : shift_left_all(value, shift - 16));
      }
      v = bit_or(widen(low), shift_left<16>(widen(high)));
    }
    store(reinterpret_cast<std::uint32_t*>(out + 4 * t), v);
  }
  return t;
}

/// The word that a plane lies in, as far as the record goes.
GICODEC_INLINE std::uint32_t read_part(const std::uint8_t* from, unsigned bytes) {
  std::uint32_t v = 0;
  std::memcpy(&v, from, bytes);
  return v;
}
GICODEC_INLINE void write_part(std::uint8_t* to, unsigned bytes, std::uint32_t v) {
  std::memcpy(to, &v, bytes);
}
/// body(bytes of that word): with a constant where it is a whole one.
template <typename Body>
GICODEC_INLINE void for_part(const PlaneLayout& layout, unsigned plane, const Body& body) {
  const unsigned rest = layout.texel_bytes - layout.plane[plane].byte;
  if (rest >= 4) {
    body(4U);
  } else {
    body(rest);
  }
}

void unpack(const PlaneLayout& layout, const std::uint8_t* in, std::size_t texels,
            std::uint16_t* __restrict planes) {
  const std::size_t done = layout.texel_bytes == 4 ? unpack32(layout, in, texels, planes) : 0;
  if (layout.pairs) {
    for (std::size_t t = done; t < texels; ++t) {
      const auto v = read<std::uint32_t>(in + 4 * t);
      planes[t] = static_cast<std::uint16_t>(v);
      planes[texels + t] = static_cast<std::uint16_t>((v >> 16) - 2 * v);
    }
    return;
  }
  for (unsigned p = 0; p < layout.planes; ++p, planes += texels) {
    const auto plane = layout.plane[p];
    const std::uint32_t mask = (1U << plane.stored) - 1;
    if (layout.texel_bytes == 4) {
      for (std::size_t t = done; t < texels; ++t) {
        planes[t] =
            static_cast<std::uint16_t>(read<std::uint32_t>(in + 4 * t) >> plane.shift & mask);
      }
    } else if (layout.texel_bytes == 2 && layout.planes == 1) {
      for (std::size_t t = 0; t < texels; ++t) planes[t] = read<std::uint16_t>(in + 2 * t);
    } else {
      for_part(layout, p, [&](unsigned bytes) {
        const std::uint8_t* from = in + plane.byte;
        for (std::size_t t = 0; t < texels; ++t, from += layout.texel_bytes) {
          planes[t] = static_cast<std::uint16_t>(read_part(from, bytes) >> plane.shift & mask);
        }
      });
    }
  }
}

void pack(const PlaneLayout& layout, const std::uint16_t* planes, std::size_t texels,
          std::uint8_t* out) {
  const std::size_t done = layout.texel_bytes == 4 ? pack32(layout, planes, texels, out) : 0;
  if (layout.pairs) {
    for (std::size_t t = done; t < texels; ++t) {
      const std::uint32_t m1 = planes[t];
      const std::uint32_t m2 = planes[texels + t] + 2 * m1;
      write(out + 4 * t, m1 | m2 << 16);
    }
    return;
  }
  if (layout.texel_bytes == 2 && layout.planes == 1) {
    for (std::size_t t = 0; t < texels; ++t) write(out + 2 * t, planes[t]);
    return;
  }
  if (layout.texel_bytes == 4) {
    for (std::size_t t = done; t < texels; ++t) {
      std::uint32_t v = 0;
      for (unsigned p = 0; p < layout.planes; ++p) {
        v |= static_cast<std::uint32_t>(planes[p * texels + t]) << layout.plane[p].shift;
      }
      write(out + 4 * t, v);
    }
    return;
  }
  std::memset(out, 0, texels * layout.texel_bytes);
  for (unsigned k = 0; k < layout.planes; ++k, planes += texels) {
    const auto plane = layout.plane[k];
    for_part(layout, k, [&](unsigned bytes) {
      std::uint8_t* to = out + plane.byte;
      for (std::size_t t = 0; t < texels; ++t, to += layout.texel_bytes) {
        const auto v = static_cast<std::uint32_t>(planes[t]) << plane.shift;
        write_part(to, bytes, read_part(to, bytes) | v);
      }
    });
  }
}

/// How many steps a value is, those of pairs rounded down, else up.
GICODEC_INLINE std::uint16_t steps_of(std::uint16_t value, std::uint16_t step,
                                      std::uint16_t inverse) {
  const auto low = static_cast<std::uint16_t>(std::uint32_t{value} * inverse >> 16);
  const auto rest = static_cast<std::uint16_t>(value - low * step);
  // One too low at most.
  return static_cast<std::uint16_t>(low + (rest > 0 ? 1 : 0) + (rest > step ? 1 : 0));
}
GICODEC_INLINE std::uint16_t inverse_of(unsigned step) {
  return static_cast<std::uint16_t>(65536U / step);
}

void to_steps(const PlaneLayout& layout, std::size_t texels, std::uint16_t* planes) {
  for (unsigned p = 0; p < layout.planes; ++p, planes += texels) {
    const std::uint16_t step = layout.plane[p].step;
    if (step == 1) continue;
    if (layout.pairs) {
      const int shift = std::countr_zero(step);
      for (std::size_t t = 0; t < texels; ++t) {
        planes[t] = static_cast<std::uint16_t>(static_cast<std::int16_t>(planes[t]) >> shift);
      }
      continue;
    }
    const std::uint16_t inverse = inverse_of(step);
    for (std::size_t t = 0; t < texels; ++t) planes[t] = steps_of(planes[t], step, inverse);
  }
}

void from_steps(const PlaneLayout& layout, std::size_t texels, std::uint16_t* planes) {
  for (unsigned p = 0; p < layout.planes; ++p, planes += texels) {
    const std::uint32_t step = layout.plane[p].step, largest = (1U << layout.plane[p].stored) - 1;
    if (step == 1) continue;
    for (std::size_t t = 0; t < texels; ++t) {
      const std::uint32_t value = planes[t] * step;
      planes[t] = static_cast<std::uint16_t>(layout.pairs || value < largest ? value : largest);
    }
  }
}

bool has_steps(const PlaneLayout& layout, unsigned plane, const std::uint16_t* values,
               std::size_t texels) {
  const std::uint16_t step = layout.plane[plane].step, inverse = inverse_of(step);
  const auto largest = static_cast<std::uint16_t>((1U << layout.plane[plane].stored) - 1);
  std::uint16_t others = 0;
  for (std::size_t t = 0; t < texels; ++t) {
    const std::uint16_t value = values[t], steps = steps_of(value, step, inverse);
    const bool whole =
        static_cast<std::uint16_t>(steps * step) == value || (!layout.pairs && value == largest);
    others |= whole ? 0 : 1;
  }
  return others == 0;
}
