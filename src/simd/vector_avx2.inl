// AVX2: 2 registers of 16 words.

using Reg = __m256i;
inline constexpr int kRegs = 2;
#define GICODEC_V(op) _mm256_##op
#define GICODEC_BITS(op) _mm256_##op##_si256
GICODEC_INLINE Reg load_reg(const void* p) {
  return _mm256_loadu_si256(static_cast<const __m256i*>(p));
}
GICODEC_INLINE void store_reg(void* p, Reg a) { _mm256_storeu_si256(static_cast<__m256i*>(p), a); }
GICODEC_INLINE Reg broadcast_table(const std::uint8_t* p) {
  return _mm256_broadcastsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
}

GICODEC_INLINE Reg join(const __m128i (&q)[2]) { return _mm256_set_m128i(q[1], q[0]); }
GICODEC_INLINE void split(Reg a, __m128i (&q)[2]) {
  q[0] = _mm256_castsi256_si128(a);
  q[1] = _mm256_extracti128_si256(a, 1);
}

#include "simd/vector_x86.inl"

struct M16 {
  Reg v[kRegs];
};
GICODEC_INLINE M16 equal(I16 a, I16 b) {
  M16 m;
  GICODEC_EACH16 m.v[i] = _mm256_cmpeq_epi16(a.v[i], b.v[i]);
  return m;
}
GICODEC_INLINE M16 greater(I16 a, I16 b) {
  M16 m;
  GICODEC_EACH16 m.v[i] = _mm256_cmpgt_epi16(a.v[i], b.v[i]);
  return m;
}
GICODEC_INLINE M16 mask_and(M16 a, M16 b) {
  GICODEC_EACH16 a.v[i] = _mm256_and_si256(a.v[i], b.v[i]);
  return a;
}
GICODEC_INLINE M16 mask_or(M16 a, M16 b) {
  GICODEC_EACH16 a.v[i] = _mm256_or_si256(a.v[i], b.v[i]);
  return a;
}
GICODEC_INLINE M16 mask_andnot(M16 a, M16 b) {
  GICODEC_EACH16 a.v[i] = _mm256_andnot_si256(b.v[i], a.v[i]);
  return a;
}
GICODEC_INLINE I16 select(M16 m, I16 a, I16 b) {
  GICODEC_EACH16 a.v[i] = _mm256_blendv_epi8(b.v[i], a.v[i], m.v[i]);
  return a;
}
GICODEC_INLINE I16 keep(M16 m, I16 a) {
  GICODEC_EACH16 a.v[i] = _mm256_and_si256(a.v[i], m.v[i]);
  return a;
}
GICODEC_INLINE std::uint32_t to_bits(M16 m) {
  const Reg packed = _mm256_permute4x64_epi64(_mm256_packs_epi16(m.v[0], m.v[1]), 0xD8);
  return static_cast<std::uint32_t>(_mm256_movemask_epi8(packed));
}
GICODEC_INLINE M16 from_bits(std::uint32_t bits) {
  const Reg each = _mm256_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192,
                                     16384, -32768);
  M16 m;
  GICODEC_EACH16 {
    const Reg all = _mm256_set1_epi16(static_cast<short>(bits >> 16 * i));
    m.v[i] = _mm256_cmpeq_epi16(_mm256_and_si256(all, each), each);
  }
  return m;
}
GICODEC_INLINE I16 lookup64(const std::uint16_t* table, I16 index) {
  alignas(32) std::uint16_t v[kLanes];
  store(v, index);
  for (unsigned l = 0; l < kLanes; ++l) v[l] = table[v[l]];
  return load(v);
}

GICODEC_INLINE U32 widen(I16 a) {
  U32 r;
  GICODEC_EACH16 {
    r.v[2 * i] = _mm256_cvtepu16_epi32(_mm256_castsi256_si128(a.v[i]));
    r.v[2 * i + 1] = _mm256_cvtepu16_epi32(_mm256_extracti128_si256(a.v[i], 1));
  }
  return r;
}
GICODEC_INLINE I16 narrow(U32 a) {
  I16 r;
  GICODEC_EACH16 r.v[i] =
      _mm256_permute4x64_epi64(_mm256_packus_epi32(a.v[2 * i], a.v[2 * i + 1]), 0xD8);
  return r;
}
GICODEC_INLINE Reg mask32(std::uint32_t bits) {
  const Reg each = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  return _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(static_cast<int>(bits)), each),
                            each);
}
GICODEC_INLINE U32 select(std::uint32_t m, U32 a, U32 b) {
  GICODEC_EACH32 a.v[i] = _mm256_blendv_epi8(b.v[i], a.v[i], mask32(m >> 8 * i));
  return a;
}
GICODEC_INLINE U32 shift_left(U32 a, U32 n) {
  GICODEC_EACH32 a.v[i] = _mm256_sllv_epi32(a.v[i], n.v[i]);
  return a;
}
GICODEC_INLINE U32 shift_right(U32 a, U32 n) {
  GICODEC_EACH32 a.v[i] = _mm256_srlv_epi32(a.v[i], n.v[i]);
  return a;
}
GICODEC_INLINE U32 quotient(U32 a, U32 b) {
  GICODEC_EACH32 {
    const __m256 ratio = _mm256_div_ps(_mm256_cvtepi32_ps(a.v[i]), _mm256_cvtepi32_ps(b.v[i]));
    Reg q = _mm256_cvttps_epi32(ratio);
    Reg r = _mm256_sub_epi32(a.v[i], _mm256_mullo_epi32(q, b.v[i]));
    const Reg low = _mm256_srai_epi32(r, 31);
    r = _mm256_add_epi32(r, _mm256_and_si256(low, b.v[i]));
    q = _mm256_add_epi32(q, low);
    a.v[i] = _mm256_sub_epi32(_mm256_add_epi32(q, _mm256_set1_epi32(1)),
                              _mm256_srli_epi32(_mm256_sub_epi32(r, b.v[i]), 31));
  }
  return a;
}
GICODEC_INLINE U32 log2_floor(U32 a) {
  GICODEC_EACH32 a.v[i] =
      _mm256_sub_epi32(_mm256_srli_epi32(_mm256_castps_si256(_mm256_cvtepi32_ps(a.v[i])), 23),
                       _mm256_set1_epi32(127));
  return a;
}

struct PermuteTables {
  std::uint8_t spread[256][8];  ///< which loaded word goes to a set lane
  std::uint8_t gather[256][8];  ///< set lanes, packed to the top
};
constexpr PermuteTables make_permutes() {
  PermuteTables t{};
  for (unsigned m = 0; m < 256; ++m) {
    unsigned k = 0;
    for (unsigned l = 0; l < 8; ++l) {
      t.spread[m][l] = static_cast<std::uint8_t>(k & 7);
      k += m >> l & 1;
    }
    unsigned at = 8 - k;
    for (unsigned l = 0; l < 8; ++l) {
      if (m >> l & 1) t.gather[m][at++] = static_cast<std::uint8_t>(l);
    }
  }
  return t;
}
alignas(64) inline constexpr PermuteTables kPermutes = make_permutes();
GICODEC_INLINE Reg permute(Reg a, const std::uint8_t* order) {
  return _mm256_permutevar8x32_epi32(
      a, _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(order))));
}

GICODEC_INLINE U32 refill(U32 x, std::uint32_t active, const std::uint8_t*& next) {
  GICODEC_EACH32 {
    const Reg low = _mm256_and_si256(_mm256_cmpgt_epi32(_mm256_set1_epi32(kStateLow), x.v[i]),
                                     mask32(active >> 8 * i));
    const auto bits = static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(low)));
    const Reg loaded =
        _mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(next)));
    const Reg full =
        _mm256_or_si256(_mm256_slli_epi32(x.v[i], 16), permute(loaded, kPermutes.spread[bits]));
    x.v[i] = _mm256_blendv_epi8(x.v[i], full, low);
    next += 2 * __builtin_popcount(bits);
  }
  return x;
}
GICODEC_INLINE U32 spill(U32 x, U32 limit, std::uint32_t active, std::uint8_t*& next) {
  for (int i = 2 * kRegs; i-- > 0;) {
    const Reg below = _mm256_cmpgt_epi32(limit.v[i], x.v[i]);
    const Reg out = _mm256_andnot_si256(below, mask32(active >> 8 * i));
    const auto bits = static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(out)));
    const Reg low =
        _mm256_and_si256(permute(x.v[i], kPermutes.gather[bits]), _mm256_set1_epi32(0xFFFF));
    // The unused words of the store lie below, where later words overwrite them.
    _mm_storeu_si128(
        reinterpret_cast<__m128i*>(next - 16),
        _mm_packus_epi32(_mm256_castsi256_si128(low), _mm256_extracti128_si256(low, 1)));
    x.v[i] = _mm256_blendv_epi8(x.v[i], _mm256_srli_epi32(x.v[i], 16), out);
    next -= 2 * __builtin_popcount(bits);
  }
  return x;
}

#include "simd/shuffle3.inl"
