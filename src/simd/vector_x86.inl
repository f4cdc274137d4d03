// Shared by SSE4.1, AVX2 and AVX-512: GICODEC_V(op) names an intrinsic of the set's width; Reg is
// its register, and kRegs of them hold 32 words of 16 bits.

struct I16 {
  Reg v[kRegs];
};
struct U32 {
  Reg v[2 * kRegs];
};

#define GICODEC_EACH16 GICODEC_UNROLL for (int i = 0; i < kRegs; ++i)
#define GICODEC_EACH32 GICODEC_UNROLL for (int i = 0; i < 2 * kRegs; ++i)

GICODEC_INLINE I16 load(const std::uint16_t* p) {
  I16 r;
  GICODEC_EACH16 r.v[i] = load_reg(reinterpret_cast<const std::uint8_t*>(p) + i * sizeof(Reg));
  return r;
}
GICODEC_INLINE void store(std::uint16_t* p, I16 a) {
  GICODEC_EACH16 store_reg(reinterpret_cast<std::uint8_t*>(p) + i * sizeof(Reg), a.v[i]);
}
GICODEC_INLINE U32 load(const std::uint32_t* p) {
  U32 r;
  GICODEC_EACH32 r.v[i] = load_reg(reinterpret_cast<const std::uint8_t*>(p) + i * sizeof(Reg));
  return r;
}
GICODEC_INLINE void store(std::uint32_t* p, U32 a) {
  GICODEC_EACH32 store_reg(reinterpret_cast<std::uint8_t*>(p) + i * sizeof(Reg), a.v[i]);
}
GICODEC_INLINE I16 set(int a) {
  I16 r;
  GICODEC_EACH16 r.v[i] = GICODEC_V(set1_epi16)(static_cast<short>(a));
  return r;
}
GICODEC_INLINE U32 set32(std::uint32_t a) {
  U32 r;
  GICODEC_EACH32 r.v[i] = GICODEC_V(set1_epi32)(static_cast<int>(a));
  return r;
}

#define GICODEC_OP(name, op)                    \
  GICODEC_INLINE I16 name(I16 a, I16 b) {       \
    GICODEC_EACH16 a.v[i] = op(a.v[i], b.v[i]); \
    return a;                                   \
  }
GICODEC_OP(add, GICODEC_V(add_epi16))
GICODEC_OP(sub, GICODEC_V(sub_epi16))
GICODEC_OP(add_sat, GICODEC_V(adds_epu16))
GICODEC_OP(mul_lo, GICODEC_V(mullo_epi16))
GICODEC_OP(mul_high, GICODEC_V(mulhi_epu16))
GICODEC_OP(mul_rounded, GICODEC_V(mulhrs_epi16))
GICODEC_OP(bit_and, GICODEC_BITS(and))
GICODEC_OP(bit_or, GICODEC_BITS(or))
GICODEC_OP(bit_xor, GICODEC_BITS(xor))
GICODEC_OP(min_u, GICODEC_V(min_epu16))
GICODEC_OP(min_s, GICODEC_V(min_epi16))
GICODEC_OP(max_s, GICODEC_V(max_epi16))
#undef GICODEC_OP

template <int n>
GICODEC_INLINE I16 shift_left(I16 a) {
  GICODEC_EACH16 a.v[i] = GICODEC_V(slli_epi16)(a.v[i], n);
  return a;
}
template <int n>
GICODEC_INLINE I16 shift_right(I16 a) {
  GICODEC_EACH16 a.v[i] = GICODEC_V(srli_epi16)(a.v[i], n);
  return a;
}
template <int n>
GICODEC_INLINE I16 shift_arithmetic(I16 a) {
  GICODEC_EACH16 a.v[i] = GICODEC_V(srai_epi16)(a.v[i], n);
  return a;
}
GICODEC_INLINE I16 shift_left_all(I16 a, unsigned n) {
  GICODEC_EACH16 a.v[i] = GICODEC_V(sll_epi16)(a.v[i], _mm_cvtsi32_si128(static_cast<int>(n)));
  return a;
}
GICODEC_INLINE I16 shift_right_all(I16 a, unsigned n) {
  GICODEC_EACH16 a.v[i] = GICODEC_V(srl_epi16)(a.v[i], _mm_cvtsi32_si128(static_cast<int>(n)));
  return a;
}
GICODEC_INLINE I16 magnitude(I16 a) {
  GICODEC_EACH16 a.v[i] = GICODEC_V(abs_epi16)(a.v[i]);
  return a;
}
/// The high byte of an index is 0 and entry 0 is 0, so a byte shuffle serves words.
GICODEC_INLINE I16 lookup16(const NibbleTable& table, I16 index) {
  const Reg entries = broadcast_table(table.entry);
  GICODEC_EACH16 index.v[i] = GICODEC_V(shuffle_epi8)(entries, index.v[i]);
  return index;
}

#define GICODEC_OP(name, op)                    \
  GICODEC_INLINE U32 name(U32 a, U32 b) {       \
    GICODEC_EACH32 a.v[i] = op(a.v[i], b.v[i]); \
    return a;                                   \
  }
GICODEC_OP(add, GICODEC_V(add_epi32))
GICODEC_OP(sub, GICODEC_V(sub_epi32))
GICODEC_OP(mul_lo, GICODEC_V(mullo_epi32))
GICODEC_OP(bit_and, GICODEC_BITS(and))
GICODEC_OP(bit_or, GICODEC_BITS(or))
#undef GICODEC_OP
template <int n>
GICODEC_INLINE U32 shift_left(U32 a) {
  GICODEC_EACH32 a.v[i] = GICODEC_V(slli_epi32)(a.v[i], n);
  return a;
}
template <int n>
GICODEC_INLINE U32 shift_right(U32 a) {
  GICODEC_EACH32 a.v[i] = GICODEC_V(srli_epi32)(a.v[i], n);
  return a;
}

/// Look-ups go lane by lane: hardware gathers are no faster, and much slower on many machines.
/// Entries go straight into registers, since a vector load would wait for scalar stores.
template <typename Find>
GICODEC_INLINE U32 collect(const Find& find) {
  constexpr int kQuads = static_cast<int>(sizeof(Reg) / 16);
  U32 r;
  GICODEC_EACH32 {
    __m128i quad[kQuads];
    for (int q = 0; q < kQuads; ++q) {
      const auto l = static_cast<unsigned>((i * kQuads + q) * 4);
      quad[q] = _mm_cvtsi32_si128(static_cast<int>(find(l)));
      quad[q] = _mm_insert_epi32(quad[q], static_cast<int>(find(l + 1)), 1);
      quad[q] = _mm_insert_epi32(quad[q], static_cast<int>(find(l + 2)), 2);
      quad[q] = _mm_insert_epi32(quad[q], static_cast<int>(find(l + 3)), 3);
    }
    r.v[i] = join(quad);
  }
  return r;
}

/// Transposes 8 × 8 words in every 128-bit part, the tile of all layout changes.
GICODEC_INLINE void transpose8(Reg (&a)[8]) {
  Reg b[8];
  GICODEC_UNROLL
  for (int i = 0; i < 4; ++i) {
    b[i] = GICODEC_V(unpacklo_epi16)(a[2 * i], a[2 * i + 1]);
    b[i + 4] = GICODEC_V(unpackhi_epi16)(a[2 * i], a[2 * i + 1]);
  }
  GICODEC_UNROLL
  for (int i = 0; i < 2; ++i) {
    a[i] = GICODEC_V(unpacklo_epi32)(b[2 * i], b[2 * i + 1]);
    a[i + 2] = GICODEC_V(unpackhi_epi32)(b[2 * i], b[2 * i + 1]);
    a[i + 4] = GICODEC_V(unpacklo_epi32)(b[2 * i + 4], b[2 * i + 5]);
    a[i + 6] = GICODEC_V(unpackhi_epi32)(b[2 * i + 4], b[2 * i + 5]);
  }
  GICODEC_UNROLL
  for (int i = 0; i < 4; ++i) {
    b[2 * i] = GICODEC_V(unpacklo_epi64)(a[2 * i], a[2 * i + 1]);
    b[2 * i + 1] = GICODEC_V(unpackhi_epi64)(a[2 * i], a[2 * i + 1]);
  }
  GICODEC_UNROLL
  for (int i = 0; i < 8; ++i) a[i] = b[i];
}
/// Values t to t + 7 of 32 blocks ↔ [value][lane].
GICODEC_INLINE void tile_to_lanes(const std::uint16_t* const* blocks, std::size_t t,
                                  std::uint16_t* lanes) {
  constexpr int kParts = sizeof(Reg) / 16;
  GICODEC_UNROLL
  for (int r = 0; r < kRegs; ++r) {
    Reg a[8];
    GICODEC_UNROLL
    for (int i = 0; i < 8; ++i) {
      __m128i part[kParts];
      GICODEC_UNROLL
      for (int k = 0; k < kParts; ++k) {
        part[k] =
            _mm_loadu_si128(reinterpret_cast<const __m128i*>(blocks[8 * (kParts * r + k) + i] + t));
      }
      a[i] = join(part);
    }
    transpose8(a);
    GICODEC_UNROLL
    for (int i = 0; i < 8; ++i) store_reg(lanes + i * kLanes + 8 * kParts * r, a[i]);
  }
}
GICODEC_INLINE void tile_from_lanes(const std::uint16_t* lanes, std::size_t t,
                                    std::uint16_t* const* blocks) {
  constexpr int kParts = sizeof(Reg) / 16;
  GICODEC_UNROLL
  for (int r = 0; r < kRegs; ++r) {
    Reg a[8];
    GICODEC_UNROLL
    for (int i = 0; i < 8; ++i) a[i] = load_reg(lanes + i * kLanes + 8 * kParts * r);
    transpose8(a);
    GICODEC_UNROLL
    for (int i = 0; i < 8; ++i) {
      __m128i part[kParts];
      split(a[i], part);
      GICODEC_UNROLL
      for (int k = 0; k < kParts; ++k) {
        _mm_storeu_si128(reinterpret_cast<__m128i*>(blocks[8 * (kParts * r + k) + i] + t), part[k]);
      }
    }
  }
}

/// A register of 16 bytes, in every set.
using Byte16 = __m128i;
GICODEC_INLINE Byte16 load16(const void* p) {
  return _mm_loadu_si128(static_cast<const __m128i*>(p));
}
GICODEC_INLINE void store16(void* p, Byte16 a) { _mm_storeu_si128(static_cast<__m128i*>(p), a); }
GICODEC_INLINE Byte16 or16(Byte16 a, Byte16 b) { return _mm_or_si128(a, b); }
GICODEC_INLINE Byte16 shuffle_bytes(Byte16 a, Byte16 control) {
  return _mm_shuffle_epi8(a, control);
}
