// NEON of AArch64.
#include "simd/vector_portable.inl"

using Byte16 = uint8x16_t;
GICODEC_INLINE Byte16 shuffle_bytes(Byte16 a, Byte16 control) { return vqtbl1q_u8(a, control); }
/// A bit per lane, of four.
GICODEC_INLINE unsigned bits_of(Reg32 mask) {
  return vaddvq_u32(as<uint32x4_t>(mask & Reg32{1, 2, 4, 8}));
}
GICODEC_INLINE Reg16 add_sat(Reg16 a, Reg16 b) {
  return as<Reg16>(vqaddq_u16(as<uint16x8_t>(a), as<uint16x8_t>(b)));
}
GICODEC_INLINE Reg16 min_u(Reg16 a, Reg16 b) {
  return as<Reg16>(vminq_u16(as<uint16x8_t>(a), as<uint16x8_t>(b)));
}
GICODEC_INLINE Reg16 min_s(Reg16 a, Reg16 b) {
  return as<Reg16>(vminq_s16(as<int16x8_t>(a), as<int16x8_t>(b)));
}
GICODEC_INLINE Reg16 max_s(Reg16 a, Reg16 b) {
  return as<Reg16>(vmaxq_s16(as<int16x8_t>(a), as<int16x8_t>(b)));
}
GICODEC_INLINE Reg16 magnitude(Reg16 a) { return as<Reg16>(vabsq_s16(as<int16x8_t>(a))); }
/// (a·b + 2^14) >> 15, saturated to 0x7FFF.
GICODEC_INLINE Reg16 mul_rounded_sat(Reg16 a, Reg16 b) {
  return as<Reg16>(vqrdmulhq_s16(as<int16x8_t>(a), as<int16x8_t>(b)));
}
GICODEC_INLINE std::uint32_t to_bits(M16 m) {
  const Byte16 each = {1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128};
  const Byte16 low = vuzp1q_u8(as<Byte16>(m.v[0]), as<Byte16>(m.v[1])) & each;
  const Byte16 high = vuzp1q_u8(as<Byte16>(m.v[2]), as<Byte16>(m.v[3])) & each;
  const Byte16 twos = vpaddq_u8(low, high), fours = vpaddq_u8(twos, twos);
  return vgetq_lane_u32(as<uint32x4_t>(vpaddq_u8(fours, fours)), 0);
}

/// Entries of a table of 64; 0 for indices beyond.
GICODEC_INLINE Reg8 lookup_bytes64(const std::uint8_t* table, Reg8 index) {
  return as<Reg8>(vqtbl4q_u8(vld1q_u8_x4(table), as<uint8x16_t>(index)));
}

#include "simd/vector_shuffle.inl"

/// Interleaved triples of bytes ↔ three planes of kTriples.
inline constexpr std::size_t kTriples = 16;
GICODEC_INLINE void split3(const std::uint8_t* from, std::uint8_t* const (&planes)[3]) {
  const uint8x16x3_t v = vld3q_u8(from);
  for (int p = 0; p < 3; ++p) vst1q_u8(planes[p], v.val[p]);
}
GICODEC_INLINE void join3(const std::uint8_t* const (&planes)[3], std::uint8_t* to) {
  const uint8x16x3_t v = {{vld1q_u8(planes[0]), vld1q_u8(planes[1]), vld1q_u8(planes[2])}};
  vst3q_u8(to, v);
}
