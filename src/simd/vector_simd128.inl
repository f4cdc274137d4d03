// SIMD128 of WebAssembly.
#include "simd/vector_portable.inl"

using Byte16 = v128_t;
GICODEC_INLINE Byte16 shuffle_bytes(Byte16 a, Byte16 control) {
  return wasm_i8x16_swizzle(a, control);
}
/// A bit per lane, of four.
GICODEC_INLINE unsigned bits_of(Reg32 mask) {
  return static_cast<unsigned>(wasm_i32x4_bitmask(as<v128_t>(mask)));
}
GICODEC_INLINE Reg16 add_sat(Reg16 a, Reg16 b) {
  return as<Reg16>(wasm_u16x8_add_sat(as<v128_t>(a), as<v128_t>(b)));
}
GICODEC_INLINE Reg16 min_u(Reg16 a, Reg16 b) {
  return as<Reg16>(wasm_u16x8_min(as<v128_t>(a), as<v128_t>(b)));
}
GICODEC_INLINE Reg16 min_s(Reg16 a, Reg16 b) {
  return as<Reg16>(wasm_i16x8_min(as<v128_t>(a), as<v128_t>(b)));
}
GICODEC_INLINE Reg16 max_s(Reg16 a, Reg16 b) {
  return as<Reg16>(wasm_i16x8_max(as<v128_t>(a), as<v128_t>(b)));
}
GICODEC_INLINE Reg16 magnitude(Reg16 a) { return as<Reg16>(wasm_i16x8_abs(as<v128_t>(a))); }
/// (a·b + 2^14) >> 15, saturated to 0x7FFF.
GICODEC_INLINE Reg16 mul_rounded_sat(Reg16 a, Reg16 b) {
  return as<Reg16>(wasm_i16x8_q15mulr_sat(as<v128_t>(a), as<v128_t>(b)));
}
GICODEC_INLINE std::uint32_t to_bits(M16 m) {
  const auto bits = [&](int i) {
    return static_cast<std::uint32_t>(
        wasm_i8x16_bitmask(wasm_i8x16_narrow_i16x8(as<v128_t>(m.v[i]), as<v128_t>(m.v[i + 1]))));
  };
  return bits(0) | bits(2) << 16;
}

/// Entries of a table of 64; 0 for indices beyond, because a swizzle gives 0 for indices above 15.
GICODEC_INLINE Reg8 lookup_bytes64(const std::uint8_t* table, Reg8 index) {
  Reg8 found{};
  GICODEC_UNROLL
  for (unsigned part = 0; part < 4; ++part) {
    const Reg8 at = index - as<Reg8>(splat32(part * 0x10101010U));
    found |= as<Reg8>(shuffle_bytes(wasm_v128_load(table + 16 * part), as<Byte16>(at)));
  }
  return found;
}

#include "simd/vector_shuffle.inl"

GICODEC_INLINE Byte16 load16(const void* p) { return wasm_v128_load(p); }
GICODEC_INLINE void store16(void* p, Byte16 a) { wasm_v128_store(p, a); }
GICODEC_INLINE Byte16 or16(Byte16 a, Byte16 b) { return wasm_v128_or(a, b); }

#include "simd/shuffle3.inl"
