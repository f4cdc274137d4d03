// Bytes of 32 lanes, for sets with masks of bytes, which define RegB, kByteRegs, table16() and
// shuffle().

#define GICODEC_EACH8 GICODEC_UNROLL for (int i = 0; i < kByteRegs; ++i)
#define GICODEC_OP(name, op)                   \
  GICODEC_INLINE B8 name(B8 a, B8 b) {         \
    GICODEC_EACH8 a.v[i] = op(a.v[i], b.v[i]); \
    return a;                                  \
  }
GICODEC_OP(add, GICODEC_V(add_epi8))
GICODEC_OP(sub, GICODEC_V(sub_epi8))
GICODEC_OP(min_u, GICODEC_V(min_epu8))
#undef GICODEC_OP
GICODEC_INLINE B8 set8(int a) {
  B8 r;
  GICODEC_EACH8 r.v[i] = GICODEC_V(set1_epi8)(static_cast<char>(a));
  return r;
}
GICODEC_INLINE void store(std::uint8_t* p, B8 a) {
  GICODEC_EACH8 store_reg(p + i * static_cast<int>(sizeof(RegB)), a.v[i]);
}
GICODEC_INLINE B8 load_bytes(const std::uint8_t* p) {
  B8 r;
  GICODEC_EACH8 r.v[i] = load_reg(p + i * static_cast<int>(sizeof(RegB)));
  return r;
}
GICODEC_INLINE M8 at_most(B8 a, B8 b) {
  M8 m;
  GICODEC_EACH8 m.v[i] = GICODEC_V(cmpeq_epi8)(GICODEC_V(min_epu8)(a.v[i], b.v[i]), a.v[i]);
  return m;
}
GICODEC_INLINE B8 select(M8 m, B8 a, B8 b) {
  GICODEC_EACH8 a.v[i] = GICODEC_V(blendv_epi8)(b.v[i], a.v[i], m.v[i]);
  return a;
}
GICODEC_INLINE B8 add_where(M8 m, B8 a, int n) {
  GICODEC_EACH8 {
    const RegB each = GICODEC_V(set1_epi8)(static_cast<char>(n));
    a.v[i] = GICODEC_V(add_epi8)(a.v[i], GICODEC_BITS(and)(m.v[i], each));
  }
  return a;
}
GICODEC_INLINE B8 lookup16(const std::uint8_t (&table)[16], B8 index) {
  const RegB entries = table16(table);
  GICODEC_EACH8 index.v[i] = shuffle(entries, index.v[i]);
  return index;
}
GICODEC_INLINE B8 lookup_quarter(const std::uint8_t (&table)[64], B8 index, B8, M8 a, M8 b, M8 c) {
  const RegB q0 = table16(table), q1 = table16(table + 16), q2 = table16(table + 32),
             q3 = table16(table + 48);
  GICODEC_EACH8 {
    const RegB at = index.v[i];
    const RegB low = GICODEC_V(blendv_epi8)(shuffle(q0, at), shuffle(q1, at), a.v[i]);
    const RegB high = GICODEC_V(blendv_epi8)(shuffle(q2, at), shuffle(q3, at), c.v[i]);
    index.v[i] = GICODEC_V(blendv_epi8)(low, high, b.v[i]);
  }
  return index;
}
/// Blends select by a byte's highest bit; shuffles need it to be 0.
GICODEC_INLINE RegB lookup64(const std::uint8_t* table, RegB index) {
  const RegB at = GICODEC_BITS(and)(index, GICODEC_V(set1_epi8)(15));
  const RegB bit4 = GICODEC_V(slli_epi16)(index, 3), bit5 = GICODEC_V(slli_epi16)(index, 2);
  const RegB low =
      GICODEC_V(blendv_epi8)(shuffle(table16(table), at), shuffle(table16(table + 16), at), bit4);
  const RegB high = GICODEC_V(blendv_epi8)(shuffle(table16(table + 32), at),
                                           shuffle(table16(table + 48), at), bit4);
  return GICODEC_V(blendv_epi8)(low, high, bit5);
}
GICODEC_INLINE B8 lookup64(const std::uint8_t (&table)[64], B8 index) {
  GICODEC_EACH8 index.v[i] = lookup64(table, index.v[i]);
  return index;
}
GICODEC_INLINE B8 lookup256(const std::uint8_t (&table)[256], B8 index) {
  GICODEC_EACH8 {
    const RegB at = index.v[i], bit6 = GICODEC_V(slli_epi16)(at, 1);
    const RegB low = GICODEC_V(blendv_epi8)(lookup64(table, at), lookup64(table + 64, at), bit6);
    const RegB high =
        GICODEC_V(blendv_epi8)(lookup64(table + 128, at), lookup64(table + 192, at), bit6);
    index.v[i] = GICODEC_V(blendv_epi8)(low, high, at);
  }
  return index;
}
inline constexpr bool kByteLookups = true;
