// SSE4.1: 4 registers of 8 words.

using Reg = __m128i;
inline constexpr int kRegs = 4;
#define GICODEC_STEP [[gnu::noinline]]
#define GICODEC_V(op) _mm_##op
#define GICODEC_BITS(op) _mm_##op##_si128
GICODEC_INLINE Reg load_reg(const void* p) {
  return _mm_loadu_si128(static_cast<const __m128i*>(p));
}
GICODEC_INLINE void store_reg(void* p, Reg a) { _mm_storeu_si128(static_cast<__m128i*>(p), a); }
GICODEC_INLINE Reg broadcast_table(const std::uint8_t* p) { return load_reg(p); }

GICODEC_INLINE Reg join(const __m128i (&q)[1]) { return q[0]; }
GICODEC_INLINE void split(Reg a, __m128i (&q)[1]) { q[0] = a; }

#include "simd/vector_x86.inl"

struct M16 {
  Reg v[kRegs];
};
GICODEC_INLINE M16 equal(I16 a, I16 b) {
  M16 m;
  GICODEC_EACH16 m.v[i] = _mm_cmpeq_epi16(a.v[i], b.v[i]);
  return m;
}
GICODEC_INLINE M16 greater(I16 a, I16 b) {
  M16 m;
  GICODEC_EACH16 m.v[i] = _mm_cmpgt_epi16(a.v[i], b.v[i]);
  return m;
}
GICODEC_INLINE M16 mask_and(M16 a, M16 b) {
  GICODEC_EACH16 a.v[i] = _mm_and_si128(a.v[i], b.v[i]);
  return a;
}
GICODEC_INLINE M16 mask_or(M16 a, M16 b) {
  GICODEC_EACH16 a.v[i] = _mm_or_si128(a.v[i], b.v[i]);
  return a;
}
GICODEC_INLINE M16 mask_andnot(M16 a, M16 b) {
  GICODEC_EACH16 a.v[i] = _mm_andnot_si128(b.v[i], a.v[i]);
  return a;
}
GICODEC_INLINE I16 select(M16 m, I16 a, I16 b) {
  GICODEC_EACH16 a.v[i] = _mm_blendv_epi8(b.v[i], a.v[i], m.v[i]);
  return a;
}
GICODEC_INLINE I16 keep(M16 m, I16 a) {
  GICODEC_EACH16 a.v[i] = _mm_and_si128(a.v[i], m.v[i]);
  return a;
}
GICODEC_INLINE std::uint32_t to_bits(M16 m) {
  const auto low = static_cast<unsigned>(_mm_movemask_epi8(_mm_packs_epi16(m.v[0], m.v[1])));
  const auto high = static_cast<unsigned>(_mm_movemask_epi8(_mm_packs_epi16(m.v[2], m.v[3])));
  return low | high << 16;
}
GICODEC_INLINE M16 from_bits(std::uint32_t bits) {
  const Reg each = _mm_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128);
  M16 m;
  GICODEC_EACH16 {
    const Reg all = _mm_set1_epi16(static_cast<short>(bits >> 8 * i & 0xFF));
    m.v[i] = _mm_cmpeq_epi16(_mm_and_si128(all, each), each);
  }
  return m;
}

/// Words moved up by n lanes within each eight of them; zeros below.
template <int n>
GICODEC_INLINE I16 up(I16 a) {
  GICODEC_EACH16 a.v[i] = _mm_bslli_si128(a.v[i], 2 * n);
  return a;
}
GICODEC_INLINE U32 widen(I16 a) {
  U32 r;
  GICODEC_EACH16 {
    r.v[2 * i] = _mm_cvtepu16_epi32(a.v[i]);
    r.v[2 * i + 1] = _mm_unpackhi_epi16(a.v[i], _mm_setzero_si128());
  }
  return r;
}
GICODEC_INLINE I16 narrow(U32 a) {
  I16 r;
  GICODEC_EACH16 r.v[i] = _mm_packus_epi32(a.v[2 * i], a.v[2 * i + 1]);
  return r;
}
GICODEC_INLINE Reg mask32(std::uint32_t bits) {
  const Reg each = _mm_setr_epi32(1, 2, 4, 8);
  return _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(static_cast<int>(bits)), each), each);
}
GICODEC_INLINE U32 select(std::uint32_t m, U32 a, U32 b) {
  GICODEC_EACH32 a.v[i] = _mm_blendv_epi8(b.v[i], a.v[i], mask32(m >> 4 * i));
  return a;
}
GICODEC_INLINE Reg power_of_two(Reg n) {  // through the exponent of a float
  return _mm_cvttps_epi32(
      _mm_castsi128_ps(_mm_slli_epi32(_mm_add_epi32(n, _mm_set1_epi32(127)), 23)));
}
GICODEC_INLINE U32 shift_left(U32 a, U32 n) {
  GICODEC_EACH32 a.v[i] = _mm_mullo_epi32(a.v[i], power_of_two(n.v[i]));
  return a;
}
GICODEC_INLINE U32 quotient(U32 a, U32 b) {
  GICODEC_EACH32 {
    // Conversions are signed, so divide half of it; the error stays below one.
    const Reg half = _mm_srli_epi32(a.v[i], 1);
    const __m128 ratio = _mm_div_ps(_mm_cvtepi32_ps(half), _mm_cvtepi32_ps(b.v[i]));
    Reg q = _mm_cvttps_epi32(_mm_add_ps(ratio, ratio));
    Reg r = _mm_sub_epi32(a.v[i], _mm_mullo_epi32(q, b.v[i]));
    const Reg low = _mm_srai_epi32(r, 31);
    r = _mm_add_epi32(r, _mm_and_si128(low, b.v[i]));
    q = _mm_add_epi32(q, low);
    a.v[i] = _mm_sub_epi32(_mm_add_epi32(q, _mm_set1_epi32(1)),
                           _mm_srli_epi32(_mm_sub_epi32(r, b.v[i]), 31));
  }
  return a;
}

#include "simd/shuffle_tables.inl"

/// Each lane of `active` whose high word is 0 reads the next word, in lane order.
GICODEC_INLINE void refill(I16& high, I16& low, std::uint32_t active, const std::uint8_t*& next) {
  const M16 empty = mask_and(equal(high, set(0)), from_bits(active));
  const std::uint32_t lanes = to_bits(empty);
  high = select(empty, low, high);
  GICODEC_EACH16 {
    const unsigned bits = lanes >> 8 * i & 0xFF;
    const Reg taken = _mm_shuffle_epi8(load_reg(next), load_reg(kSpread.words[bits]));
    low.v[i] = _mm_blendv_epi8(low.v[i], taken, empty.v[i]);
    next += 2 * __builtin_popcount(bits);
  }
}
GICODEC_INLINE U32 spill(U32 x, U32 limit, std::uint32_t active, std::uint8_t*& next) {
  for (int i = 2 * kRegs; i-- > 0;) {
    const Reg least = _mm_min_epu32(limit.v[i], x.v[i]);
    const Reg out = _mm_and_si128(_mm_cmpeq_epi32(least, limit.v[i]), mask32(active >> 4 * i));
    const auto bits = static_cast<unsigned>(_mm_movemask_ps(_mm_castsi128_ps(out)));
    // Unused words of the store lie below; later words overwrite them.
    _mm_storel_epi64(reinterpret_cast<__m128i*>(next - 8),
                     _mm_shuffle_epi8(x.v[i], load_reg(kShuffles.gather[bits])));
    x.v[i] = _mm_blendv_epi8(x.v[i], _mm_srli_epi32(x.v[i], 16), out);
    next -= kShuffles.bytes[bits];
  }
  return x;
}

using RegB = __m128i;
inline constexpr int kByteRegs = 2;
GICODEC_INLINE RegB table16(const std::uint8_t* p) { return load_reg(p); }
GICODEC_INLINE RegB shuffle(RegB table, RegB index) { return _mm_shuffle_epi8(table, index); }
struct B8 {
  RegB v[kByteRegs];
};
struct M8 {
  RegB v[kByteRegs];
};
GICODEC_INLINE B8 bytes(I16 a) {
  return {{_mm_packus_epi16(a.v[0], a.v[1]), _mm_packus_epi16(a.v[2], a.v[3])}};
}
GICODEC_INLINE I16 words(B8 a) {
  const Reg zero = _mm_setzero_si128();
  return {{_mm_cvtepu8_epi16(a.v[0]), _mm_unpackhi_epi8(a.v[0], zero), _mm_cvtepu8_epi16(a.v[1]),
           _mm_unpackhi_epi8(a.v[1], zero)}};
}

#include "simd/bytes_x86.inl"

#include "simd/shuffle3.inl"
