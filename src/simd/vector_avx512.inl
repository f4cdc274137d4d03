// AVX-512 (F, BW, DQ, VL, CD, VBMI, VBMI2): one register of 32 words.

using Reg = __m512i;
inline constexpr int kRegs = 1;
#define GICODEC_STEP GICODEC_INLINE_STEP
#define GICODEC_V(op) _mm512_##op
#define GICODEC_BITS(op) _mm512_##op##_si512
GICODEC_INLINE Reg load_reg(const void* p) { return _mm512_loadu_si512(p); }
GICODEC_INLINE void store_reg(void* p, Reg a) { _mm512_storeu_si512(p, a); }
GICODEC_INLINE Reg broadcast_table(const std::uint8_t* p) {
  return _mm512_broadcast_i32x4(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
}

GICODEC_INLINE Reg join(const __m128i (&q)[4]) {
  return _mm512_inserti64x4(_mm512_castsi256_si512(_mm256_set_m128i(q[1], q[0])),
                            _mm256_set_m128i(q[3], q[2]), 1);
}
GICODEC_INLINE void split(Reg a, __m128i (&q)[4]) {
  q[0] = _mm512_castsi512_si128(a);
  q[1] = _mm512_extracti32x4_epi32(a, 1);
  q[2] = _mm512_extracti32x4_epi32(a, 2);
  q[3] = _mm512_extracti32x4_epi32(a, 3);
}

#include "simd/vector_x86.inl"

struct M16 {
  __mmask32 bits;
};
GICODEC_INLINE M16 equal(I16 a, I16 b) { return {_mm512_cmpeq_epi16_mask(a.v[0], b.v[0])}; }
GICODEC_INLINE M16 greater(I16 a, I16 b) { return {_mm512_cmpgt_epi16_mask(a.v[0], b.v[0])}; }
GICODEC_INLINE M16 mask_and(M16 a, M16 b) { return {_kand_mask32(a.bits, b.bits)}; }
GICODEC_INLINE M16 mask_or(M16 a, M16 b) { return {_kor_mask32(a.bits, b.bits)}; }
GICODEC_INLINE M16 mask_andnot(M16 a, M16 b) { return {_kandn_mask32(b.bits, a.bits)}; }
GICODEC_INLINE I16 select(M16 m, I16 a, I16 b) {
  return {{_mm512_mask_blend_epi16(m.bits, b.v[0], a.v[0])}};
}
GICODEC_INLINE I16 keep(M16 m, I16 a) { return {{_mm512_maskz_mov_epi16(m.bits, a.v[0])}}; }
GICODEC_INLINE std::uint32_t to_bits(M16 m) { return m.bits; }
GICODEC_INLINE M16 from_bits(std::uint32_t bits) { return {bits}; }

/// Words moved up by n lanes within each eight of them; zeros below.
template <int n>
GICODEC_INLINE I16 up(I16 a) {
  GICODEC_EACH16 a.v[i] = _mm512_bslli_epi128(a.v[i], 2 * n);
  return a;
}
GICODEC_INLINE U32 widen(I16 a) {
  return {{_mm512_cvtepu16_epi32(_mm512_castsi512_si256(a.v[0])),
           _mm512_cvtepu16_epi32(_mm512_extracti64x4_epi64(a.v[0], 1))}};
}
struct EvenWords {
  std::uint16_t index[kLanes];
};
constexpr EvenWords make_even_words() {
  EvenWords even{};
  for (unsigned l = 0; l < kLanes; ++l) even.index[l] = static_cast<std::uint16_t>(2 * l);
  return even;
}
alignas(64) inline constexpr EvenWords kEvenWords = make_even_words();
GICODEC_INLINE I16 narrow(U32 a) {
  return {{_mm512_permutex2var_epi16(a.v[0], load_reg(kEvenWords.index), a.v[1])}};
}
GICODEC_INLINE __mmask16 mask32(std::uint32_t bits) { return static_cast<__mmask16>(bits); }
GICODEC_INLINE U32 select(std::uint32_t m, U32 a, U32 b) {
  GICODEC_EACH32 a.v[i] = _mm512_mask_blend_epi32(mask32(m >> 16 * i), b.v[i], a.v[i]);
  return a;
}
GICODEC_INLINE U32 shift_left(U32 a, U32 n) {
  GICODEC_EACH32 a.v[i] = _mm512_sllv_epi32(a.v[i], n.v[i]);
  return a;
}
GICODEC_INLINE U32 quotient(U32 a, U32 b) {
  GICODEC_EACH32 {
    const __m512 ratio = _mm512_div_ps(_mm512_cvtepu32_ps(a.v[i]), _mm512_cvtepu32_ps(b.v[i]));
    Reg q = _mm512_cvttps_epi32(ratio);
    Reg r = _mm512_sub_epi32(a.v[i], _mm512_mullo_epi32(q, b.v[i]));
    const __mmask16 low = _mm512_movepi32_mask(r);
    r = _mm512_mask_add_epi32(r, low, r, b.v[i]);
    q = _mm512_mask_sub_epi32(q, low, q, _mm512_set1_epi32(1));
    const __mmask16 high = _mm512_cmpge_epi32_mask(r, b.v[i]);
    a.v[i] = _mm512_mask_add_epi32(q, high, q, _mm512_set1_epi32(1));
  }
  return a;
}

GICODEC_INLINE void refill(I16& high, I16& low, std::uint32_t active, const std::uint8_t*& next) {
  const __mmask32 empty = _mm512_mask_cmpeq_epi16_mask(active, high.v[0], _mm512_setzero_si512());
  high.v[0] = _mm512_mask_mov_epi16(high.v[0], empty, low.v[0]);
  low.v[0] = _mm512_mask_expand_epi16(low.v[0], empty, load_reg(next));
  next += 2 * bits_set(empty);
}
GICODEC_INLINE U32 spill(U32 x, U32 limit, std::uint32_t active, std::uint8_t*& next) {
  for (int i = 2 * kRegs; i-- > 0;) {
    const __mmask16 out =
        _mm512_mask_cmpge_epu32_mask(mask32(active >> 16 * i), x.v[i], limit.v[i]);
    const int count = bits_set(out);
    next -= 2 * count;
    _mm256_mask_storeu_epi16(next, static_cast<__mmask16>((1U << count) - 1),
                             _mm512_cvtepi32_epi16(_mm512_maskz_compress_epi32(out, x.v[i])));
    x.v[i] = _mm512_mask_srli_epi32(x.v[i], out, x.v[i], 16);
  }
  return x;
}

/// 64 byte indices into three registers: one permutation of the first two; a second, of the third
/// register, replaces the bytes in `mask`.
struct Permute3 {
  alignas(64) std::uint8_t index[3][64];  // 0-63 and 64-127: the first two; then the third's 0-63
  std::uint64_t mask[3];
};
constexpr Permute3 make_permute3(bool split) {
  Permute3 table{};
  for (int out = 0; out < 3; ++out) {
    for (int i = 0; i < 64; ++i) {
      // Split: byte i of plane `out`. Join: byte 64·out + i of the interleaved bytes.
      const int at = 64 * out + i;
      const int from = split ? 3 * i + out : at % 3 * 64 + at / 3;
      table.index[out][i] = static_cast<std::uint8_t>(from < 128 ? from : from - 128);
      if (from >= 128) table.mask[out] |= std::uint64_t{1} << i;
    }
  }
  return table;
}
inline constexpr Permute3 kSplit3 = make_permute3(true), kJoin3 = make_permute3(false);
GICODEC_INLINE void permute3(const void* const (&from)[3], const Permute3& table,
                             void* const (&to)[3]) {
  const Reg a = load_reg(from[0]), b = load_reg(from[1]), c = load_reg(from[2]);
  for (int out = 0; out < 3; ++out) {
    const Reg index = load_reg(table.index[out]);
    const Reg low = _mm512_permutex2var_epi8(a, index, b);
    store_reg(to[out], _mm512_mask_permutexvar_epi8(low, table.mask[out], index, c));
  }
}
inline constexpr std::size_t kTriples = 64;
GICODEC_INLINE void split3(const std::uint8_t* from, std::uint8_t* const (&planes)[3]) {
  permute3({from, from + 64, from + 128}, kSplit3, {planes[0], planes[1], planes[2]});
}
GICODEC_INLINE void join3(const std::uint8_t* const (&planes)[3], std::uint8_t* to) {
  permute3({planes[0], planes[1], planes[2]}, kJoin3, {to, to + 64, to + 128});
}

using Byte32 = __m256i;
struct B8 {
  Byte32 v;
};
struct M8 {
  __mmask32 bits;
};
GICODEC_INLINE B8 bytes(I16 a) { return {_mm512_cvtepi16_epi8(a.v[0])}; }
GICODEC_INLINE I16 words(B8 a) { return {{_mm512_cvtepu8_epi16(a.v)}}; }
GICODEC_INLINE void store(std::uint8_t* p, B8 a) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), a.v);
}
GICODEC_INLINE B8 set8(int a) { return {_mm256_set1_epi8(static_cast<char>(a))}; }
GICODEC_INLINE B8 add(B8 a, B8 b) { return {_mm256_add_epi8(a.v, b.v)}; }
GICODEC_INLINE B8 sub(B8 a, B8 b) { return {_mm256_sub_epi8(a.v, b.v)}; }
GICODEC_INLINE B8 min_u(B8 a, B8 b) { return {_mm256_min_epu8(a.v, b.v)}; }
GICODEC_INLINE M8 at_most(B8 a, B8 b) { return {_mm256_cmple_epu8_mask(a.v, b.v)}; }
GICODEC_INLINE B8 select(M8 m, B8 a, B8 b) { return {_mm256_mask_blend_epi8(m.bits, b.v, a.v)}; }
GICODEC_INLINE B8 add_where(M8 m, B8 a, int n) {
  return {_mm256_mask_add_epi8(a.v, m.bits, a.v, _mm256_set1_epi8(static_cast<char>(n)))};
}
GICODEC_INLINE Byte32 load32(const std::uint8_t* p) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
}
GICODEC_INLINE B8 load_bytes(const std::uint8_t* p) { return {load32(p)}; }
GICODEC_INLINE B8 lookup16(const std::uint8_t (&table)[16], B8 index) {
  const __m128i entries = _mm_loadu_si128(reinterpret_cast<const __m128i*>(table));
  return {_mm256_shuffle_epi8(_mm256_broadcastsi128_si256(entries), index.v)};
}
GICODEC_INLINE B8 lookup64(const std::uint8_t (&table)[64], B8 index) {
  return {_mm256_permutex2var_epi8(load32(table), index.v, load32(table + 32))};
}
GICODEC_INLINE B8 lookup_quarter(const std::uint8_t (&table)[64], B8 index, B8 quarter, M8, M8,
                                 M8) {
  const __m256i upper = _mm256_slli_epi16(quarter.v, 4);  // below 4: no bit leaves its byte
  return lookup64(table, {_mm256_or_si256(index.v, upper)});
}
GICODEC_INLINE B8 lookup256(const std::uint8_t (&table)[256], B8 index) {
  const __m512i at = _mm512_castsi256_si512(index.v);
  const __m512i low = _mm512_permutex2var_epi8(load_reg(table), at, load_reg(table + 64));
  const __m512i high = _mm512_permutex2var_epi8(load_reg(table + 128), at, load_reg(table + 192));
  return {_mm256_mask_blend_epi8(_mm256_movepi8_mask(index.v), _mm512_castsi512_si256(low),
                                 _mm512_castsi512_si256(high))};
}
inline constexpr bool kByteLookups = true;
