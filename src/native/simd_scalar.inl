// Vector wrapper without vectors: 32 lanes in plain arrays. Defines the meaning of every operation.

struct I16 {
  std::uint16_t v[kLanes];
};
struct U32 {
  std::uint32_t v[kLanes];
};
struct M16 {
  std::uint32_t bits;
};

#define GICODEC_EACH for (unsigned l = 0; l < kLanes; ++l)

GICODEC_INLINE std::int16_t sgn(std::uint16_t a) { return static_cast<std::int16_t>(a); }
GICODEC_INLINE std::uint16_t u16(int a) { return static_cast<std::uint16_t>(a); }

GICODEC_INLINE I16 load(const std::uint16_t* p) {
  I16 r;
  std::memcpy(r.v, p, sizeof r.v);
  return r;
}
GICODEC_INLINE void store(std::uint16_t* p, I16 a) { std::memcpy(p, a.v, sizeof a.v); }
GICODEC_INLINE U32 load(const std::uint32_t* p) {
  U32 r;
  std::memcpy(r.v, p, sizeof r.v);
  return r;
}
GICODEC_INLINE void store(std::uint32_t* p, U32 a) { std::memcpy(p, a.v, sizeof a.v); }
GICODEC_INLINE I16 set(int a) {
  I16 r;
  GICODEC_EACH r.v[l] = u16(a);
  return r;
}

#define GICODEC_OP(name, expression)      \
  GICODEC_INLINE I16 name(I16 a, I16 b) { \
    GICODEC_EACH a.v[l] = expression;     \
    return a;                             \
  }
GICODEC_OP(add, u16(a.v[l] + b.v[l]))
GICODEC_OP(sub, u16(a.v[l] - b.v[l]))
GICODEC_OP(add_sat, u16(a.v[l] + b.v[l] > 65535 ? 65535 : a.v[l] + b.v[l]))  // unsigned
GICODEC_OP(mul_lo, u16(static_cast<int>(static_cast<std::uint32_t>(a.v[l]) * b.v[l] & 0xFFFF)))
GICODEC_OP(mul_rounded, u16((sgn(a.v[l]) * sgn(b.v[l]) + 16384) >> 15))  // signed Q15
GICODEC_OP(bit_and, u16(a.v[l] & b.v[l]))
GICODEC_OP(bit_or, u16(a.v[l] | b.v[l]))
GICODEC_OP(bit_xor, u16(a.v[l] ^ b.v[l]))
GICODEC_OP(min_u, a.v[l] < b.v[l] ? a.v[l] : b.v[l])
GICODEC_OP(max_s, sgn(a.v[l]) > sgn(b.v[l]) ? a.v[l] : b.v[l])
#undef GICODEC_OP

template <int n>
GICODEC_INLINE I16 shift_left(I16 a) {
  GICODEC_EACH a.v[l] = u16(a.v[l] << n);
  return a;
}
template <int n>
GICODEC_INLINE I16 shift_right(I16 a) {
  GICODEC_EACH a.v[l] = u16(a.v[l] >> n);
  return a;
}
template <int n>
GICODEC_INLINE I16 shift_arithmetic(I16 a) {
  GICODEC_EACH a.v[l] = u16(sgn(a.v[l]) >> n);
  return a;
}
/// n ≤ 31.
GICODEC_INLINE I16 shift_left_all(I16 a, unsigned n) {
  GICODEC_EACH a.v[l] = static_cast<std::uint16_t>(std::uint32_t{a.v[l]} << n);
  return a;
}
GICODEC_INLINE I16 shift_right_all(I16 a, unsigned n) {
  GICODEC_EACH a.v[l] = static_cast<std::uint16_t>(std::uint32_t{a.v[l]} >> n);
  return a;
}
GICODEC_INLINE I16 magnitude(I16 a) {
  GICODEC_EACH if (sgn(a.v[l]) < 0) a.v[l] = u16(-a.v[l]);
  return a;
}
/// Entries of a 16-byte table with entry 0 = 0; indices below 16.
GICODEC_INLINE I16 lookup16(const NibbleTable& t, I16 i) {
  GICODEC_EACH i.v[l] = t.entry[i.v[l]];
  return i;
}
/// Entries of a 64-word table; indices below 64.
GICODEC_INLINE I16 lookup64(const std::uint16_t* t, I16 i) {
  GICODEC_EACH i.v[l] = t[i.v[l]];
  return i;
}

GICODEC_INLINE std::uint32_t sum_lanes(I16 a) {
  std::uint32_t n = 0;
  GICODEC_EACH n += a.v[l];
  return n;
}

GICODEC_INLINE M16 from_bits(std::uint32_t bits) { return {bits}; }
GICODEC_INLINE std::uint32_t to_bits(M16 m) { return m.bits; }
#define GICODEC_COMPARE(name, expression)                               \
  GICODEC_INLINE M16 name(I16 a, I16 b) {                               \
    M16 m{0};                                                           \
    GICODEC_EACH m.bits |= static_cast<std::uint32_t>(expression) << l; \
    return m;                                                           \
  }
GICODEC_COMPARE(equal, a.v[l] == b.v[l])
GICODEC_COMPARE(greater, sgn(a.v[l]) > sgn(b.v[l]))  // signed
#undef GICODEC_COMPARE
GICODEC_INLINE M16 mask_and(M16 a, M16 b) { return {a.bits & b.bits}; }
GICODEC_INLINE M16 mask_or(M16 a, M16 b) { return {a.bits | b.bits}; }
GICODEC_INLINE M16 mask_andnot(M16 a, M16 b) { return {a.bits & ~b.bits}; }
GICODEC_INLINE I16 select(M16 m, I16 a, I16 b) {
  GICODEC_EACH if (!(m.bits >> l & 1)) a.v[l] = b.v[l];
  return a;
}
GICODEC_INLINE I16 keep(M16 m, I16 a) {
  GICODEC_EACH if (!(m.bits >> l & 1)) a.v[l] = 0;
  return a;
}

GICODEC_INLINE U32 widen(I16 a) {
  U32 r;
  GICODEC_EACH r.v[l] = a.v[l];
  return r;
}
GICODEC_INLINE I16 narrow(U32 a) {
  I16 r;
  GICODEC_EACH r.v[l] = static_cast<std::uint16_t>(a.v[l]);
  return r;
}
/// Code of every lane, by context and slot.
GICODEC_INLINE U32 find_slots(const Tables& t, I16 context, U32 slot) {
  GICODEC_EACH {
    const Distribution& d = distribution(t, context.v[l]);
    slot.v[l] = d.codes[d.slots[slot.v[l]]];
  }
  return slot;
}
/// Code or price of every lane, by context and token.
template <std::uint32_t (Distribution::*kTable)[64]>
GICODEC_INLINE U32 find_by_token(const Tables& t, const std::uint16_t* context,
                                 const std::uint16_t* token) {
  U32 r;
  GICODEC_EACH r.v[l] = (distribution(t, context[l]).*kTable)[token[l]];
  return r;
}
GICODEC_INLINE U32 set32(std::uint32_t a) {
  U32 r;
  GICODEC_EACH r.v[l] = a;
  return r;
}
#define GICODEC_OP(name, expression)      \
  GICODEC_INLINE U32 name(U32 a, U32 b) { \
    GICODEC_EACH a.v[l] = expression;     \
    return a;                             \
  }
GICODEC_OP(add, a.v[l] + b.v[l])
GICODEC_OP(sub, a.v[l] - b.v[l])
GICODEC_OP(mul_lo, a.v[l] * b.v[l])
GICODEC_OP(bit_and, a.v[l] & b.v[l])
GICODEC_OP(bit_or, a.v[l] | b.v[l])
GICODEC_OP(shift_left, a.v[l] << b.v[l])
GICODEC_OP(shift_right, a.v[l] >> b.v[l])
GICODEC_OP(quotient, a.v[l] / b.v[l])  // b is not 0, the result is below 2^19
#undef GICODEC_OP
template <int n>
GICODEC_INLINE U32 shift_left(U32 a) {
  GICODEC_EACH a.v[l] <<= n;
  return a;
}
template <int n>
GICODEC_INLINE U32 shift_right(U32 a) {
  GICODEC_EACH a.v[l] >>= n;
  return a;
}
GICODEC_INLINE U32 select(std::uint32_t m, U32 a, U32 b) {
  GICODEC_EACH if (!(m >> l & 1)) a.v[l] = b.v[l];
  return a;
}
/// Position of the leading one; inputs 1..65535.
GICODEC_INLINE U32 log2_floor(U32 a) {
  GICODEC_EACH a.v[l] = 31U - static_cast<unsigned>(__builtin_clz(a.v[l]));
  return a;
}

/// Lanes of `active` below kStateLow take in the next word, in lane order.
GICODEC_INLINE U32 refill(U32 x, std::uint32_t active, const std::uint8_t*& next) {
  GICODEC_EACH if (x.v[l] < kStateLow && (active >> l & 1)) {
    std::uint16_t word;
    std::memcpy(&word, next, 2);
    next += 2;
    x.v[l] = x.v[l] << 16 | word;
  }
  return x;
}
/// The inverse: lanes of `active` at `limit` or above put out their low word.
GICODEC_INLINE U32 spill(U32 x, U32 limit, std::uint32_t active, std::uint8_t*& next) {
  for (unsigned l = kLanes; l-- > 0;) {
    if (x.v[l] >= limit.v[l] && (active >> l & 1)) {
      const auto word = static_cast<std::uint16_t>(x.v[l]);
      next -= 2;
      std::memcpy(next, &word, 2);
      x.v[l] >>= 16;
    }
  }
  return x;
}
GICODEC_INLINE void tile_to_lanes(const std::uint16_t* const* blocks, std::size_t t,
                                  std::uint16_t* lanes) {
  for (unsigned i = 0; i < 8; ++i) {
    GICODEC_EACH lanes[i * kLanes + l] = blocks[l][t + i];
  }
}
GICODEC_INLINE void tile_from_lanes(const std::uint16_t* lanes, std::size_t t,
                                    std::uint16_t* const* blocks) {
  for (unsigned i = 0; i < 8; ++i) {
    GICODEC_EACH blocks[l][t + i] = lanes[i * kLanes + l];
  }
}
#undef GICODEC_EACH
