// What sets with byte shuffles, saturating sums and the like share; they name them for registers.

#include "simd/shuffle_tables.inl"

#define GICODEC_OP(name)                          \
  GICODEC_INLINE I16 name(I16 a, I16 b) {         \
    GICODEC_EACH16 a.v[i] = name(a.v[i], b.v[i]); \
    return a;                                     \
  }
GICODEC_OP(add_sat)
GICODEC_OP(min_u)
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

GICODEC_INLINE U32 refill(U32 x, std::uint32_t active, const std::uint8_t*& next) {
  GICODEC_EACH32 {
    const Reg32 low = as<Reg32>(x.v[i] < splat32(kStateLow)) & mask32(active >> 4 * i);
    const unsigned bits = bits_of(low);
    const Reg32 words =
        as<Reg32>(shuffle_bytes(load_reg<Byte16>(next), load_reg<Byte16>(kShuffles.spread[bits])));
    x.v[i] = blend(low, x.v[i] << 16U | words, x.v[i]);
    next += kShuffles.bytes[bits];
  }
  return x;
}
GICODEC_INLINE U32 spill(U32 x, U32 limit, std::uint32_t active, std::uint8_t*& next) {
  for (int i = 2 * kRegs; i-- > 0;) {
    const Reg32 out = as<Reg32>(x.v[i] >= limit.v[i]) & mask32(active >> 4 * i);
    const unsigned bits = bits_of(out);
    const Reg64 words =
        as<Reg64>(shuffle_bytes(as<Byte16>(x.v[i]), load_reg<Byte16>(kShuffles.gather[bits])));
    // The unused words of the store lie below, where later words overwrite them.
    store_reg(next - 8, static_cast<std::uint64_t>(words[0]));
    x.v[i] = blend(out, x.v[i] >> 16U, x.v[i]);
    next -= kShuffles.bytes[bits];
  }
  return x;
}
