// AVX2: 2 registers of 16 words.

using Reg = __m256i;
inline constexpr int kRegs = 2;
#define GICODEC_STEP GICODEC_INLINE_STEP
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

/// Words moved up by n lanes within each eight of them; zeros below.
template <int n>
GICODEC_INLINE I16 up(I16 a) {
  GICODEC_EACH16 a.v[i] = _mm256_bslli_epi128(a.v[i], 2 * n);
  return a;
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
GICODEC_INLINE U32 quotient(U32 a, U32 b) {
  GICODEC_EACH32 {
    // Conversions are signed, so divide half of it; the error stays below one.
    const Reg half = _mm256_srli_epi32(a.v[i], 1);
    const __m256 ratio = _mm256_div_ps(_mm256_cvtepi32_ps(half), _mm256_cvtepi32_ps(b.v[i]));
    Reg q = _mm256_cvttps_epi32(_mm256_add_ps(ratio, ratio));
    Reg r = _mm256_sub_epi32(a.v[i], _mm256_mullo_epi32(q, b.v[i]));
    const Reg low = _mm256_srai_epi32(r, 31);
    r = _mm256_add_epi32(r, _mm256_and_si256(low, b.v[i]));
    q = _mm256_add_epi32(q, low);
    a.v[i] = _mm256_sub_epi32(_mm256_add_epi32(q, _mm256_set1_epi32(1)),
                              _mm256_srli_epi32(_mm256_sub_epi32(r, b.v[i]), 31));
  }
  return a;
}

#include "simd/shuffle_tables.inl"

GICODEC_INLINE __m128i loaded(const std::uint8_t* p) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
}
/// Each lane of `active` whose high word is 0 reads the next word, in lane order.
GICODEC_INLINE void refill(I16& high, I16& low, std::uint32_t active, const std::uint8_t*& next) {
  const M16 empty = mask_and(equal(high, set(0)), from_bits(active));
  const std::uint32_t lanes = to_bits(empty);
  high = select(empty, low, high);
  GICODEC_EACH16 {
    const unsigned first = lanes >> 16 * i & 0xFF, second = lanes >> (16 * i + 8) & 0xFF;
    const std::uint8_t* const then = next + 2 * bits_set(first);
    const Reg taken = _mm256_shuffle_epi8(
        _mm256_set_m128i(loaded(then), loaded(next)),
        _mm256_set_m128i(loaded(kSpread.words[second]), loaded(kSpread.words[first])));
    low.v[i] = _mm256_blendv_epi8(low.v[i], taken, empty.v[i]);
    next = then + 2 * bits_set(second);
  }
}
struct PermuteTables {
  std::uint8_t gather[256][8];  ///< set lanes, packed to the top
};
constexpr PermuteTables make_permutes() {
  PermuteTables t{};
  for (unsigned m = 0; m < 256; ++m) {
    unsigned at = 8 - static_cast<unsigned>(std::popcount(m));
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
GICODEC_INLINE U32 spill(U32 x, U32 limit, std::uint32_t active, std::uint8_t*& next) {
  for (int i = 2 * kRegs; i-- > 0;) {
    const Reg least = _mm256_min_epu32(limit.v[i], x.v[i]);
    const Reg out =
        _mm256_and_si256(_mm256_cmpeq_epi32(least, limit.v[i]), mask32(active >> 8 * i));
    const auto bits = static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(out)));
    const Reg low =
        _mm256_and_si256(permute(x.v[i], kPermutes.gather[bits]), _mm256_set1_epi32(0xFFFF));
    // Unused words of the store lie below; later words overwrite them.
    _mm_storeu_si128(
        reinterpret_cast<__m128i*>(next - 16),
        _mm_packus_epi32(_mm256_castsi256_si128(low), _mm256_extracti128_si256(low, 1)));
    x.v[i] = _mm256_blendv_epi8(x.v[i], _mm256_srli_epi32(x.v[i], 16), out);
    next -= 2 * bits_set(bits);
  }
  return x;
}

using RegB = __m256i;
inline constexpr int kByteRegs = 1;
GICODEC_INLINE RegB table16(const std::uint8_t* p) { return broadcast_table(p); }
GICODEC_INLINE RegB shuffle(RegB table, RegB index) { return _mm256_shuffle_epi8(table, index); }
struct B8 {
  RegB v[kByteRegs];
};
struct M8 {
  RegB v[kByteRegs];
};
GICODEC_INLINE B8 bytes(I16 a) {
  return {{_mm256_permute4x64_epi64(_mm256_packus_epi16(a.v[0], a.v[1]), 0xD8)}};
}
GICODEC_INLINE I16 words(B8 a) {
  return {{_mm256_cvtepu8_epi16(_mm256_castsi256_si128(a.v[0])),
           _mm256_cvtepu8_epi16(_mm256_extracti128_si256(a.v[0], 1))}};
}

#include "simd/bytes_x86.inl"

#include "simd/shuffle3.inl"
