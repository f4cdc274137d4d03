// The baseline, without intrinsics. It defines the meaning of every operation.
#include "simd/vector_portable.inl"

GICODEC_OP16(add_sat, (a + b) | as<Reg16>(a + b < a))  // unsigned
GICODEC_OP16(min_u, blend(as<Reg16>(a < b), a, b))
GICODEC_OP16(min_s, blend(as<Reg16>(as<Signed16>(a) < as<Signed16>(b)), a, b))
GICODEC_OP16(max_s, blend(as<Reg16>(as<Signed16>(a) > as<Signed16>(b)), a, b))
#undef GICODEC_OP16
/// Signed Q15.
GICODEC_INLINE I16 mul_rounded(I16 a, I16 b) {
  GICODEC_EACH16 {
    const Reg32 x = as<Reg32>(a.v[i]), y = as<Reg32>(b.v[i]);
    const Signed32 even = (as<Signed32>(x << 16U) >> 16) * (as<Signed32>(y << 16U) >> 16);
    const Signed32 odd = (as<Signed32>(x) >> 16) * (as<Signed32>(y) >> 16);
    const Reg32 half = splat32(1U << 14);
    a.v[i] = as<Reg16>(((as<Reg32>(even) + half) >> 15U & splat32(0xFFFF)) |
                       (as<Reg32>(odd) + half) >> 15U << 16U);
  }
  return a;
}
GICODEC_INLINE I16 magnitude(I16 a) {
  GICODEC_EACH16 {
    const Reg16 sign = as<Reg16>(as<Signed16>(a.v[i]) >> 15);
    a.v[i] = (a.v[i] ^ sign) - sign;
  }
  return a;
}
/// Precondition: indices are below 16.
GICODEC_INLINE I16 lookup16(const NibbleTable& table, I16 index) {
  alignas(16) std::uint16_t v[kLanes];
  store(v, index);
  for (unsigned l = 0; l < kLanes; ++l) v[l] = table.entry[v[l]];
  return load(v);
}
GICODEC_INLINE std::uint32_t to_bits(M16 m) {
  std::uint32_t bits = 0;
  GICODEC_EACH16 {
    // A different bit of each lane, summed in the highest lane.
    const Reg16 each{1, 2, 4, 8, 1, 2, 4, 8};
    const Reg64 half = as<Reg64>(m.v[i] & each);
    const auto low = half[0] * 0x0001000100010001 >> 48, high = half[1] * 0x0001000100010001 >> 48;
    bits |= static_cast<std::uint32_t>(low | high << 4) << 8 * i;
  }
  return bits;
}

/// A bit per lane of a mask whose lanes have all bits set or none.
GICODEC_INLINE std::uint32_t to_bits(U32 mask) {
  const I16 words = narrow(mask);
  M16 m;
  GICODEC_EACH16 m.v[i] = words.v[i];
  return to_bits(m);
}
/// Each lane of `active` whose high word is 0 reads the next word, in lane order.
GICODEC_INLINE void refill(I16& high, I16& low, std::uint32_t active, const std::uint8_t*& next) {
  std::uint32_t lanes = to_bits(equal(high, set(0))) & active;
  if (lanes == 0) return;
  alignas(16) std::uint16_t h[kLanes], l[kLanes];
  store(h, high);
  store(l, low);
  for (; lanes != 0; lanes &= lanes - 1, next += 2) {
    const int lane = __builtin_ctz(lanes);
    h[lane] = l[lane];
    std::memcpy(&l[lane], next, 2);
  }
  high = load(h);
  low = load(l);
}
/// The inverse: each lane of `active` at `limit` or above writes its low word.
GICODEC_INLINE U32 spill(U32 x, U32 limit, std::uint32_t active, std::uint8_t*& next) {
  U32 high;
  GICODEC_EACH32 high.v[i] = as<Reg32>(x.v[i] >= limit.v[i]);
  std::uint32_t lanes = to_bits(high) & active;
  if (lanes == 0) return x;
  alignas(16) std::uint32_t v[kLanes];
  store(v, x);
  while (lanes != 0) {
    const auto l = 31U - static_cast<unsigned>(__builtin_clz(lanes));
    lanes ^= 1U << l;
    const auto word = static_cast<std::uint16_t>(v[l]);
    next -= 2;
    std::memcpy(next, &word, 2);
    v[l] >>= 16;
  }
  return load(v);
}

/// Look-ups go lane by lane: without byte shuffles, several small tables gain nothing.
inline constexpr bool kByteLookups = false;
template <std::size_t n>
GICODEC_INLINE B8 lookup_lanes(const std::uint8_t (&table)[n], B8 index) {
  alignas(16) std::uint8_t v[kLanes];
  store(v, index);
  for (unsigned l = 0; l < kLanes; ++l) v[l] = table[v[l]];
  return load_bytes(v);
}
GICODEC_INLINE B8 lookup16(const std::uint8_t (&table)[16], B8 index) {
  return lookup_lanes(table, index);
}
GICODEC_INLINE B8 lookup64(const std::uint8_t (&table)[64], B8 index) {
  return lookup_lanes(table, index);
}
/// Looks up one of four tables of 16 by `quarter`; the masks are lanes where it is 1, 2, above 2.
GICODEC_INLINE B8 lookup_quarter(const std::uint8_t (&table)[64], B8 index, B8 quarter, M8, M8,
                                 M8) {
  GICODEC_EACH8 index.v[i] += quarter.v[i] << std::uint8_t{4};
  return lookup_lanes(table, index);
}
GICODEC_INLINE B8 lookup256(const std::uint8_t (&table)[256], B8 index) {
  return lookup_lanes(table, index);
}

/// Interleaved triples of bytes ↔ three planes of kTriples. One by one: compilers vectorise it.
inline constexpr std::size_t kTriples = 1;
GICODEC_INLINE void split3(const std::uint8_t* from, std::uint8_t* const (&planes)[3]) {
  for (unsigned p = 0; p < 3; ++p) *planes[p] = from[p];
}
GICODEC_INLINE void join3(const std::uint8_t* const (&planes)[3], std::uint8_t* to) {
  for (unsigned p = 0; p < 3; ++p) to[p] = *planes[p];
}
