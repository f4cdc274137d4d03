// Causal neighbourhood of a texel, prediction and contexts: the same in both directions.

/// Offsets of the neighbours of a texel in arrays [texel][lane] (docs/native.md, "Neighbourhood and
/// contexts").
struct Around {
  std::ptrdiff_t w, n, nw, ne;  ///< all to the same texel where a neighbour is missing
  bool first;                   ///< there is none
};
GICODEC_INLINE Around around(unsigned width, unsigned i, unsigned j) {
  const auto at = static_cast<std::ptrdiff_t>(std::size_t{j} * width + i);
  const auto lanes = static_cast<std::ptrdiff_t>(kLanes);
  const auto row = static_cast<std::ptrdiff_t>(width);
  if (j == 0) {
    const std::ptrdiff_t w = (at - 1) * lanes;
    return {w, w, w, w, i == 0};
  }
  const std::ptrdiff_t n = at - row;
  return {(i > 0 ? at - 1 : n) * lanes, n * lanes, (i > 0 ? n - 1 : n) * lanes,
          (i + 1 < width ? n + 1 : n) * lanes, false};
}

struct Four {
  I16 w, n, nw, ne;
};
GICODEC_INLINE Four neighbours(const std::uint16_t* base, const Around& a) {
  if (a.first) return {set(0), set(0), set(0), set(0)};
  return {load(base + a.w), load(base + a.n), load(base + a.nw), load(base + a.ne)};
}

/// Weights of an operator for every lane, each lane by its own mode. Narrow planes use eighths in
/// 16 bits; deep ones (`wide`) Q15 products rounded one by one, since sums would not fit.
struct Weights {
  I16 w, n, nw, ne, cross;
};
GICODEC_INLINE int q15(int eighths) { return eighths >= 8 ? 32767 : eighths * 4096; }
GICODEC_INLINE Weights uniform_weights(const Mode& m, bool wide) {
  if (wide) return {set(q15(m.w)), set(q15(m.n)), set(q15(m.nw)), set(q15(m.ne)), set(m.cross)};
  return {set(m.w), set(m.n), set(m.nw), set(m.ne), set(m.cross)};
}
GICODEC_INLINE Weights lane_weights(const Mode* modes, const std::uint16_t* choice, bool wide) {
  alignas(64) std::uint16_t v[5][kLanes];
  for (unsigned l = 0; l < kLanes; ++l) {
    const Mode& m = modes[choice[l] & (kModes - 1)];
    v[0][l] = static_cast<std::uint16_t>(wide ? q15(m.w) : m.w);
    v[1][l] = static_cast<std::uint16_t>(wide ? q15(m.n) : m.n);
    v[2][l] = static_cast<std::uint16_t>(wide ? q15(m.nw) : m.nw);
    v[3][l] = static_cast<std::uint16_t>(wide ? q15(m.ne) : m.ne);
    v[4][l] = m.cross;
  }
  return {load(v[0]), load(v[1]), load(v[2]), load(v[3]), load(v[4])};
}
GICODEC_INLINE I16 apply_wide(const Weights& k, const Four& d) {
  return add(add(mul_rounded(d.w, k.w), mul_rounded(d.n, k.n)),
             add(mul_rounded(d.nw, k.nw), mul_rounded(d.ne, k.ne)));
}
GICODEC_INLINE I16 apply_narrow(const Weights& k, const Four& d) {
  const I16 sum =
      add(add(mul_lo(d.w, k.w), mul_lo(d.n, k.n)), add(mul_lo(d.nw, k.nw), mul_lo(d.ne, k.ne)));
  return shift_arithmetic<3>(add(sum, set(4)));
}
/// a·e0 with a in quarters.
GICODEC_INLINE I16 apply_cross(const Weights& k, I16 e0) {
  return shift_arithmetic<2>(add(mul_lo(e0, k.cross), set(2)));
}

/// The context of a residual by those around.
struct LocalContext {
  I16 energy;  ///< 2|W| + 2|N| + |NW| + |NE|
  I16 sign;    ///< sign part of the context
  I16 flip;    ///< where it is negative the residual is coded with its sign inverted
};
GICODEC_INLINE LocalContext local_context(const Four& e) {
  const I16 aw = magnitude(e.w), an = magnitude(e.n);
  const I16 near = add_sat(aw, an);
  LocalContext local;
  local.energy = add_sat(add_sat(near, near), add_sat(magnitude(e.nw), magnitude(e.ne)));
  const I16 zero = set(0);
  const M16 no_w = equal(e.w, zero), no_n = equal(e.n, zero);
  local.flip = select(no_w, e.n, e.w);
  const I16 both = select(greater(zero, bit_xor(e.w, e.n)), set(3 * kSignStep), set(2 * kSignStep));
  local.sign = select(mask_or(no_w, no_n), set(kSignStep), both);
  local.sign = select(mask_and(no_w, no_n), zero, local.sign);
  return local;
}
GICODEC_INLINE I16 sign_of(I16 a) { return max_s(min_s(a, set(1)), set(-1)); }
/// Noise changes all planes of a texel in one direction: flip and context by the signs of earlier
/// planes (`votes`, -2..2) and of the residuals around, in lanes of `follows`.
GICODEC_INLINE void follow(M16 follows, I16 votes, const Four& e, LocalContext& local, I16& size) {
  const I16 both = add(add(add(votes, votes), votes), sign_of(add(e.w, e.n)));
  local.flip = select(follows, both, local.flip);
  local.sign = select(follows, shift_left<3>(magnitude(both)), local.sign);
  size = select(follows, min_u(size, set(7)), size);
}
struct MagnitudeTables {
  NibbleTable by1, by4, by16, by256;
};
constexpr MagnitudeTables magnitude_tables(const Thresholds& t) {
  return {magnitude_table(t, 0), magnitude_table(t, 2), magnitude_table(t, 4),
          magnitude_table(t, 8)};
}
inline constexpr MagnitudeTables kNarrowMagnitudes = magnitude_tables(kNarrowThresholds),
                                 kWideMagnitudes = magnitude_tables(kWideThresholds);
/// Number of thresholds ≤ s.
GICODEC_INLINE I16 magnitude_class(I16 s, const MagnitudeTables& t) {
  const I16 top = set(15);
  const I16 a =
      max_s(lookup16(t.by1, min_u(s, top)), lookup16(t.by4, min_u(shift_right<2>(s), top)));
  const I16 b = max_s(lookup16(t.by16, min_u(shift_right<4>(s), top)),
                      lookup16(t.by256, min_u(shift_right<8>(s), top)));
  return max_s(a, b);
}

/// Residual ↔ coded value: sign inverted where `lead` is negative, then zigzag.
GICODEC_INLINE I16 fold(I16 flip, I16 a) {
  const I16 inverts = shift_arithmetic<15>(flip);
  return sub(bit_xor(a, inverts), inverts);
}
GICODEC_INLINE I16 to_value(I16 e, I16 flip) {
  const I16 f = fold(flip, e);
  return bit_xor(shift_left<1>(f), shift_arithmetic<15>(f));
}
GICODEC_INLINE I16 from_value(I16 u, I16 flip) {
  const I16 f = bit_xor(shift_right<1>(u), sub(set(0), bit_and(u, set(1))));
  return fold(flip, f);
}

/// The two directions. A coder returns the residual of every active lane: the forward one gets it
/// and appends a step, the inverse one reads it.
struct Modeller {
  Step* next;
  bool ok() const { return true; }
  GICODEC_INLINE void note(I16 context, std::uint32_t active, bool repeat, unsigned place,
                           unsigned plane, I16 value) {
    next->active = active;
    next->repeat = repeat ? 1 : 0;
    next->place = static_cast<std::uint16_t>(place);
    next->plane = static_cast<std::uint16_t>(plane);
    store(next->context, context);
    store(next->value, value);
    ++next;
  }
  GICODEC_INLINE I16 token(unsigned place, unsigned plane, I16 context, std::uint32_t active,
                           I16 flip, I16 residual) {
    note(context, active, false, place, plane, to_value(residual, flip));
    return residual;
  }
  GICODEC_INLINE I16 repeat(I16 context, std::uint32_t active, I16 symbol) {
    note(context, active, true, kRepeatPlace, 0, symbol);
    return symbol;
  }
  GICODEC_INLINE I16 row_repeat(I16 context, std::uint32_t active, I16 symbol) {
    return repeat(context, active, symbol);
  }
};
struct Reader {
  const Tables& tables;
  Input& in;
  bool ok() const { return in_bounds(in); }
  GICODEC_INLINE I16 token(unsigned place, unsigned, I16 context, std::uint32_t active, I16 flip,
                           I16) {
    return from_value(decode_tokens(*tables.role[place], context, active, in), flip);
  }
  GICODEC_INLINE I16 repeat(I16 context, std::uint32_t active, I16) {
    return decode_repeats(*tables.repeats, context, active, in);
  }
  GICODEC_INLINE I16 row_repeat(I16 context, std::uint32_t active, I16) {
    return decode_repeats(*tables.rows, context, active, in);
  }
};
/// Class part of every lane's contexts.
GICODEC_INLINE I16 lane_classes(const Mode* modes, const std::uint16_t* choice) {
  alignas(64) std::uint16_t v[kLanes];
  for (unsigned l = 0; l < kLanes; ++l) {
    v[l] = static_cast<std::uint16_t>(modes[choice[l] & (kModes - 1)].context_class * kClassStep);
  }
  return load(v);
}
