// Vectors of 16 bytes by GCC's and clang's extensions: shared by the baseline, NEON and SIMD128.
// The baseline compiles to the architecture's minimum (SSE2 on x86-64).

using Reg16 [[gnu::vector_size(16)]] = std::uint16_t;
using Signed16 [[gnu::vector_size(16)]] = std::int16_t;
using Reg32 [[gnu::vector_size(16)]] = std::uint32_t;
using Signed32 [[gnu::vector_size(16)]] = std::int32_t;
using RegF [[gnu::vector_size(16)]] = float;
using Reg8 [[gnu::vector_size(16)]] = std::uint8_t;
using Reg64 [[gnu::vector_size(16)]] = std::uint64_t;
inline constexpr int kRegs = 4;
#define GICODEC_STEP [[gnu::noinline]]

struct I16 {
  Reg16 v[kRegs];
};
struct U32 {
  Reg32 v[2 * kRegs];
};
/// All bits of a lane or none.
struct M16 {
  Reg16 v[kRegs];
};

#define GICODEC_EACH16 GICODEC_UNROLL for (int i = 0; i < kRegs; ++i)
#define GICODEC_EACH32 GICODEC_UNROLL for (int i = 0; i < 2 * kRegs; ++i)

template <typename To, typename From>
GICODEC_INLINE To as(From v) {
  return reinterpret_cast<To>(v);
}
template <typename Reg>
GICODEC_INLINE Reg load_reg(const void* p) {
  Reg v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
template <typename Reg>
GICODEC_INLINE void store_reg(void* p, Reg v) {
  std::memcpy(p, &v, sizeof v);
}
GICODEC_INLINE Reg16 splat(std::uint16_t a) { return Reg16{a, a, a, a, a, a, a, a}; }
GICODEC_INLINE Reg32 splat32(std::uint32_t a) { return Reg32{a, a, a, a}; }

GICODEC_INLINE I16 load(const std::uint16_t* p) {
  I16 r;
  GICODEC_EACH16 r.v[i] = load_reg<Reg16>(p + 8 * i);
  return r;
}
GICODEC_INLINE void store(std::uint16_t* p, I16 a) { GICODEC_EACH16 store_reg(p + 8 * i, a.v[i]); }
GICODEC_INLINE U32 load(const std::uint32_t* p) {
  U32 r;
  GICODEC_EACH32 r.v[i] = load_reg<Reg32>(reinterpret_cast<const std::uint8_t*>(p) + 16 * i);
  return r;
}
GICODEC_INLINE void store(std::uint32_t* p, U32 a) {
  GICODEC_EACH32 store_reg(reinterpret_cast<std::uint8_t*>(p) + 16 * i, a.v[i]);
}
GICODEC_INLINE I16 set(int a) {
  I16 r;
  GICODEC_EACH16 r.v[i] = splat(static_cast<std::uint16_t>(a));
  return r;
}
GICODEC_INLINE U32 set32(std::uint32_t a) {
  U32 r;
  GICODEC_EACH32 r.v[i] = splat32(a);
  return r;
}

#define GICODEC_OP16(name, expression)    \
  GICODEC_INLINE I16 name(I16 x, I16 y) { \
    GICODEC_EACH16 {                      \
      const Reg16 a = x.v[i], b = y.v[i]; \
      x.v[i] = as<Reg16>(expression);     \
    }                                     \
    return x;                             \
  }
GICODEC_OP16(add, a + b)
GICODEC_OP16(sub, a - b)
GICODEC_OP16(mul_lo, a* b)
GICODEC_OP16(bit_and, a& b)
GICODEC_OP16(bit_or, a | b)
GICODEC_OP16(bit_xor, a ^ b)

template <int n>
GICODEC_INLINE I16 shift_left(I16 a) {
  GICODEC_EACH16 a.v[i] = a.v[i] << std::uint16_t{n};
  return a;
}
template <int n>
GICODEC_INLINE I16 shift_right(I16 a) {
  GICODEC_EACH16 a.v[i] = a.v[i] >> std::uint16_t{n};
  return a;
}
template <int n>
GICODEC_INLINE I16 shift_arithmetic(I16 a) {
  GICODEC_EACH16 a.v[i] = as<Reg16>(as<Signed16>(a.v[i]) >> std::int16_t{n});
  return a;
}
/// n ≤ 31.
GICODEC_INLINE I16 shift_left_all(I16 a, unsigned n) {
  const auto by = static_cast<std::uint16_t>(n & 15);
  GICODEC_EACH16 a.v[i] = n < 16 ? a.v[i] << by : Reg16{};
  return a;
}
GICODEC_INLINE I16 shift_right_all(I16 a, unsigned n) {
  const auto by = static_cast<std::uint16_t>(n & 15);
  GICODEC_EACH16 a.v[i] = n < 16 ? a.v[i] >> by : Reg16{};
  return a;
}
/// Words moved up by n lanes within each eight of them; zeros below.
template <int n>
GICODEC_INLINE I16 up(I16 a) {
  GICODEC_EACH16 {
    const Reg64 whole = as<Reg64>(a.v[i]);
    const std::uint64_t carried = n < 4 ? whole[0] >> (64 - 16 * n) % 64 : 0;
    const std::uint64_t low = n < 4 ? whole[0] << 16 * n % 64 : 0;
    const std::uint64_t high = n < 4 ? whole[1] << 16 * n % 64 | carried : whole[0];
    a.v[i] = as<Reg16>(Reg64{low, high});
  }
  return a;
}
/// High half of the unsigned product. Compilers recognise the loop.
GICODEC_INLINE I16 mul_high(I16 a, I16 b) {
  alignas(16) std::uint16_t x[kLanes], y[kLanes];
  store(x, a);
  store(y, b);
  for (unsigned l = 0; l < kLanes; ++l) {
    x[l] = static_cast<std::uint16_t>(std::uint32_t{x[l]} * y[l] >> 16);
  }
  return load(x);
}

#define GICODEC_COMPARE(name, expression) \
  GICODEC_INLINE M16 name(I16 x, I16 y) { \
    M16 m;                                \
    GICODEC_EACH16 {                      \
      const Reg16 a = x.v[i], b = y.v[i]; \
      m.v[i] = as<Reg16>(expression);     \
    }                                     \
    return m;                             \
  }
GICODEC_COMPARE(equal, a == b)
GICODEC_COMPARE(greater, as<Signed16>(a) > as<Signed16>(b))  // signed
#undef GICODEC_COMPARE
GICODEC_INLINE M16 mask_and(M16 a, M16 b) {
  GICODEC_EACH16 a.v[i] &= b.v[i];
  return a;
}
GICODEC_INLINE M16 mask_or(M16 a, M16 b) {
  GICODEC_EACH16 a.v[i] |= b.v[i];
  return a;
}
GICODEC_INLINE M16 mask_andnot(M16 a, M16 b) {
  GICODEC_EACH16 a.v[i] &= ~b.v[i];
  return a;
}
template <typename Reg>
GICODEC_INLINE Reg blend(Reg mask, Reg a, Reg b) {
  return (a & mask) | (b & ~mask);
}
GICODEC_INLINE I16 select(M16 m, I16 a, I16 b) {
  GICODEC_EACH16 a.v[i] = blend(m.v[i], a.v[i], b.v[i]);
  return a;
}
GICODEC_INLINE I16 keep(M16 m, I16 a) {
  GICODEC_EACH16 a.v[i] &= m.v[i];
  return a;
}
GICODEC_INLINE M16 from_bits(std::uint32_t bits) {
  const Reg16 each{1, 2, 4, 8, 16, 32, 64, 128};
  M16 m;
  GICODEC_EACH16 {
    const Reg16 all = splat(static_cast<std::uint16_t>(bits >> 8 * i & 0xFF));
    m.v[i] = as<Reg16>((all & each) == each);
  }
  return m;
}

GICODEC_INLINE U32 widen(I16 a) {
  U32 r;
  GICODEC_EACH16 {
    r.v[2 * i] = as<Reg32>(__builtin_shufflevector(a.v[i], Reg16{}, 0, 8, 1, 9, 2, 10, 3, 11));
    r.v[2 * i + 1] =
        as<Reg32>(__builtin_shufflevector(a.v[i], Reg16{}, 4, 12, 5, 13, 6, 14, 7, 15));
  }
  return r;
}
GICODEC_INLINE I16 narrow(U32 a) {
  I16 r;
  GICODEC_EACH16 r.v[i] = __builtin_shufflevector(as<Reg16>(a.v[2 * i]), as<Reg16>(a.v[2 * i + 1]),
                                                  0, 2, 4, 6, 8, 10, 12, 14);
  return r;
}

#define GICODEC_OP32(name, expression)    \
  GICODEC_INLINE U32 name(U32 x, U32 y) { \
    GICODEC_EACH32 {                      \
      const Reg32 a = x.v[i], b = y.v[i]; \
      x.v[i] = expression;                \
    }                                     \
    return x;                             \
  }
GICODEC_OP32(add, a + b)
GICODEC_OP32(sub, a - b)
GICODEC_OP32(mul_lo, a* b)
GICODEC_OP32(bit_and, a& b)
GICODEC_OP32(bit_or, a | b)
GICODEC_OP32(shift_left, a << b)
#undef GICODEC_OP32
template <int n>
GICODEC_INLINE U32 shift_left(U32 a) {
  GICODEC_EACH32 a.v[i] = a.v[i] << std::uint32_t{n};
  return a;
}
template <int n>
GICODEC_INLINE U32 shift_right(U32 a) {
  GICODEC_EACH32 a.v[i] = a.v[i] >> std::uint32_t{n};
  return a;
}
GICODEC_INLINE Reg32 mask32(std::uint32_t bits) {
  const Reg32 each{1, 2, 4, 8};
  return as<Reg32>((splat32(bits) & each) == each);
}
GICODEC_INLINE U32 select(std::uint32_t m, U32 a, U32 b) {
  GICODEC_EACH32 a.v[i] = blend(mask32(m >> 4 * i), a.v[i], b.v[i]);
  return a;
}
GICODEC_INLINE RegF to_floats(Reg32 a) { return __builtin_convertvector(as<Signed32>(a), RegF); }
/// Preconditions: b is not 0, the result is below 2^20. Conversions are signed, so it divides
/// halves; their quotient is wrong by one at most.
GICODEC_INLINE U32 quotient(U32 a, U32 b) {
  GICODEC_EACH32 {
    const RegF ratio = to_floats(a.v[i] >> 1U) / to_floats(b.v[i]);
    Reg32 q = as<Reg32>(__builtin_convertvector(ratio + ratio, Signed32));
    Reg32 r = a.v[i] - q * b.v[i];
    const Reg32 low = as<Reg32>(as<Signed32>(r) >> 31);
    r += low & b.v[i];
    q += low;
    a.v[i] = q + splat32(1) - ((r - b.v[i]) >> 31U);
  }
  return a;
}
/// find(lane) for every lane.
template <typename Find>
GICODEC_INLINE U32 collect(const Find& find) {
  U32 r;
  GICODEC_EACH32 {
    const auto l = static_cast<unsigned>(4 * i);
    r.v[i] = Reg32{find(l), find(l + 1), find(l + 2), find(l + 3)};
  }
  return r;
}

/// Bytes of 32 lanes.
inline constexpr int kByteRegs = 2;
struct B8 {
  Reg8 v[kByteRegs];
};
/// All bits of a lane or none.
struct M8 {
  Reg8 v[kByteRegs];
};
#define GICODEC_EACH8 GICODEC_UNROLL for (int i = 0; i < kByteRegs; ++i)
/// Values below 256, and back.
GICODEC_INLINE B8 bytes(I16 a) {
  B8 r;
  GICODEC_EACH8 r.v[i] =
      __builtin_shufflevector(as<Reg8>(a.v[2 * i]), as<Reg8>(a.v[2 * i + 1]), 0, 2, 4, 6, 8, 10, 12,
                              14, 16, 18, 20, 22, 24, 26, 28, 30);
  return r;
}
GICODEC_INLINE I16 words(B8 a) {
  I16 r;
  GICODEC_EACH8 {
    r.v[2 * i] = as<Reg16>(__builtin_shufflevector(a.v[i], Reg8{}, 0, 16, 1, 17, 2, 18, 3, 19, 4,
                                                   20, 5, 21, 6, 22, 7, 23));
    r.v[2 * i + 1] = as<Reg16>(__builtin_shufflevector(a.v[i], Reg8{}, 8, 24, 9, 25, 10, 26, 11, 27,
                                                       12, 28, 13, 29, 14, 30, 15, 31));
  }
  return r;
}
GICODEC_INLINE void store(std::uint8_t* p, B8 a) { GICODEC_EACH8 store_reg(p + 16 * i, a.v[i]); }
GICODEC_INLINE B8 load_bytes(const std::uint8_t* p) {
  B8 r;
  GICODEC_EACH8 r.v[i] = load_reg<Reg8>(p + 16 * i);
  return r;
}
GICODEC_INLINE B8 set8(int a) {
  B8 r;
  const auto each = static_cast<std::uint32_t>(a & 0xFF) * 0x01010101U;
  GICODEC_EACH8 r.v[i] = as<Reg8>(splat32(each));
  return r;
}
GICODEC_INLINE B8 add(B8 a, B8 b) {
  GICODEC_EACH8 a.v[i] += b.v[i];
  return a;
}
GICODEC_INLINE B8 sub(B8 a, B8 b) {
  GICODEC_EACH8 a.v[i] -= b.v[i];
  return a;
}
GICODEC_INLINE M8 at_most(B8 a, B8 b) {
  M8 m;
  GICODEC_EACH8 m.v[i] = as<Reg8>(a.v[i] <= b.v[i]);
  return m;
}
GICODEC_INLINE B8 select(M8 m, B8 a, B8 b) {
  GICODEC_EACH8 a.v[i] = blend(m.v[i], a.v[i], b.v[i]);
  return a;
}
GICODEC_INLINE B8 min_u(B8 a, B8 b) { return select(at_most(a, b), a, b); }
/// Adds n in the lanes of the mask.
GICODEC_INLINE B8 add_where(M8 m, B8 a, int n) {
  const B8 each = set8(n);
  GICODEC_EACH8 a.v[i] += m.v[i] & each.v[i];
  return a;
}

/// Transposes 8 × 8 words, the tile of all layout changes.
GICODEC_INLINE void transpose8(Reg16 (&a)[8]) {
  Reg32 b[8];
  GICODEC_UNROLL
  for (int i = 0; i < 4; ++i) {
    b[i] = as<Reg32>(__builtin_shufflevector(a[2 * i], a[2 * i + 1], 0, 8, 1, 9, 2, 10, 3, 11));
    b[i + 4] =
        as<Reg32>(__builtin_shufflevector(a[2 * i], a[2 * i + 1], 4, 12, 5, 13, 6, 14, 7, 15));
  }
  Reg64 c[8];
  GICODEC_UNROLL
  for (int i = 0; i < 2; ++i) {
    c[i] = as<Reg64>(__builtin_shufflevector(b[2 * i], b[2 * i + 1], 0, 4, 1, 5));
    c[i + 2] = as<Reg64>(__builtin_shufflevector(b[2 * i], b[2 * i + 1], 2, 6, 3, 7));
    c[i + 4] = as<Reg64>(__builtin_shufflevector(b[2 * i + 4], b[2 * i + 5], 0, 4, 1, 5));
    c[i + 6] = as<Reg64>(__builtin_shufflevector(b[2 * i + 4], b[2 * i + 5], 2, 6, 3, 7));
  }
  GICODEC_UNROLL
  for (int i = 0; i < 4; ++i) {
    a[2 * i] = as<Reg16>(__builtin_shufflevector(c[2 * i], c[2 * i + 1], 0, 2));
    a[2 * i + 1] = as<Reg16>(__builtin_shufflevector(c[2 * i], c[2 * i + 1], 1, 3));
  }
}
/// Values t to t + 7 of 32 blocks ↔ [value][lane].
GICODEC_INLINE void tile_to_lanes(const std::uint16_t* const* blocks, std::size_t t,
                                  std::uint16_t* lanes) {
  for (unsigned r = 0; r < kRegs; ++r) {
    Reg16 a[8];
    GICODEC_UNROLL
    for (unsigned i = 0; i < 8; ++i) a[i] = load_reg<Reg16>(blocks[8 * r + i] + t);
    transpose8(a);
    GICODEC_UNROLL
    for (unsigned i = 0; i < 8; ++i) store_reg(lanes + i * kLanes + 8 * r, a[i]);
  }
}
GICODEC_INLINE void tile_from_lanes(const std::uint16_t* lanes, std::size_t t,
                                    std::uint16_t* const* blocks) {
  for (unsigned r = 0; r < kRegs; ++r) {
    Reg16 a[8];
    GICODEC_UNROLL
    for (unsigned i = 0; i < 8; ++i) a[i] = load_reg<Reg16>(lanes + i * kLanes + 8 * r);
    transpose8(a);
    GICODEC_UNROLL
    for (unsigned i = 0; i < 8; ++i) store_reg(blocks[8 * r + i] + t, a[i]);
  }
}
