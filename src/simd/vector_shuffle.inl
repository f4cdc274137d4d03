// Shared by sets with byte shuffles and saturating sums, which they define for registers.

#include "simd/shuffle_tables.inl"

#define GICODEC_OP(name)                          \
  GICODEC_INLINE I16 name(I16 a, I16 b) {         \
    GICODEC_EACH16 a.v[i] = name(a.v[i], b.v[i]); \
    return a;                                     \
  }
GICODEC_OP(add_sat)
GICODEC_OP(min_u)
GICODEC_OP(min_s)
GICODEC_OP(max_s)
#undef GICODEC_OP
#undef GICODEC_OP16
GICODEC_INLINE I16 mul_rounded(I16 a, I16 b) {
  const Reg16 least = splat(0x8000);
  GICODEC_EACH16 {
    const Reg16 wraps = as<Reg16>((a.v[i] == least) & (b.v[i] == least));
    a.v[i] = mul_rounded_sat(a.v[i], b.v[i]) ^ wraps;
  }
  return a;
}
GICODEC_INLINE I16 magnitude(I16 a) {
  GICODEC_EACH16 a.v[i] = magnitude(a.v[i]);
  return a;
}
/// The high byte of an index is 0 and entry 0 is 0, so a byte shuffle serves words.
GICODEC_INLINE I16 lookup16(const NibbleTable& table, I16 index) {
  const auto entries = load_reg<Byte16>(table.entry);
  GICODEC_EACH16 index.v[i] = as<Reg16>(shuffle_bytes(entries, as<Byte16>(index.v[i])));
  return index;
}

/// Each lane of `active` whose high word is 0 reads the next word, in lane order.
GICODEC_INLINE void refill(I16& high, I16& low, std::uint32_t active, const std::uint8_t*& next) {
  const M16 empty = mask_and(equal(high, set(0)), from_bits(active));
  const std::uint32_t lanes = to_bits(empty);
  high = select(empty, low, high);
  GICODEC_EACH16 {
    const unsigned bits = lanes >> 8 * i & 0xFF;
    const Byte16 taken =
        shuffle_bytes(load_reg<Byte16>(next), load_reg<Byte16>(kSpread.words[bits]));
    low.v[i] = blend(empty.v[i], as<Reg16>(taken), low.v[i]);
    next += 2 * __builtin_popcount(bits);
  }
}
GICODEC_INLINE U32 spill(U32 x, U32 limit, std::uint32_t active, std::uint8_t*& next) {
  for (int i = 2 * kRegs; i-- > 0;) {
    const Reg32 out = as<Reg32>(x.v[i] >= limit.v[i]) & mask32(active >> 4 * i);
    const unsigned bits = bits_of(out);
    const Reg64 words =
        as<Reg64>(shuffle_bytes(as<Byte16>(x.v[i]), load_reg<Byte16>(kShuffles.gather[bits])));
    // Unused words of the store lie below; later words overwrite them.
    store_reg(next - 8, static_cast<std::uint64_t>(words[0]));
    x.v[i] = blend(out, x.v[i] >> 16U, x.v[i]);
    next -= kShuffles.bytes[bits];
  }
  return x;
}

GICODEC_INLINE Reg8 shuffle(const std::uint8_t* table, Reg8 index) {
  return as<Reg8>(shuffle_bytes(load_reg<Byte16>(table), as<Byte16>(index)));
}
GICODEC_INLINE B8 lookup16(const std::uint8_t (&table)[16], B8 index) {
  GICODEC_EACH8 index.v[i] = shuffle(table, index.v[i]);
  return index;
}
GICODEC_INLINE B8 lookup64(const std::uint8_t (&table)[64], B8 index) {
  GICODEC_EACH8 index.v[i] = lookup_bytes64(table, index.v[i]);
  return index;
}
GICODEC_INLINE B8 lookup_quarter(const std::uint8_t (&table)[64], B8 index, B8 quarter, M8, M8,
                                 M8) {
  GICODEC_EACH8 index.v[i] |= quarter.v[i] << std::uint8_t{4};
  return lookup64(table, index);
}
GICODEC_INLINE B8 lookup256(const std::uint8_t (&table)[256], B8 index) {
  GICODEC_EACH8 {
    // A part gives 0 for indices beyond its 64 entries.
    Reg8 found = lookup_bytes64(table, index.v[i]);
    for (unsigned part = 1; part < 4; ++part) {
      const Reg8 at = index.v[i] - as<Reg8>(splat32(part * 0x40404040U));
      found |= lookup_bytes64(table + 64 * part, at);
    }
    index.v[i] = found;
  }
  return index;
}
inline constexpr bool kByteLookups = true;
