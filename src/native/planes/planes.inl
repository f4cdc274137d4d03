// Integer planes (colour and all generic formats): one mode per block for all planes.

/// Sign extension of a difference of values of `bits` bits.
GICODEC_INLINE I16 wrap(I16 a, unsigned bits) {
  const I16 half = set(1 << (bits - 1));
  return sub(bit_xor(bit_and(a, set((1 << bits) - 1)), half), half);
}
GICODEC_INLINE bool is_wide(unsigned bits) { return bits > 11; }

/// What stays the same while a group is coded.
struct PlaneCoding {
  const Group& group;
  std::size_t plane_size;
  std::uint16_t* difference;  ///< [plane][texel][lane]
  std::uint16_t* residual;
  Weights weights[2];      ///< for narrow and for wide planes
  I16 context_class;       ///< class part of each lane's contexts
  std::uint16_t* matched;  ///< [texel][lane]: repeats
  std::uint16_t* choice;
  std::uint16_t* exponent;  ///< [texel][lane], if shared
  std::uint16_t* scale;     ///< [reference, W, N, NW, NE][texel][lane]: what mantissas there count
  bool scaled;              ///< exponents are shared, and coded
  M16 follows;              ///< lanes of kFollowClass
  bool any_follows;
};

/// Neighbours that do not exist are the last record before that does. What does not exist repeats
/// the record before, so that this is the last one stored.
GICODEC_INLINE I16 last_before(const std::uint16_t* here, const Around& near) {
  return near.first ? set(0) : load(here - kLanes);
}
GICODEC_INLINE void replace_absent(const Group& g, const std::uint16_t* here, const Around& near,
                                   Four& around) {
  if (near.first) return;
  const I16 last = last_before(here, near);
  const auto replace = [&](std::ptrdiff_t from, I16& value) {
    const std::ptrdiff_t back = from / static_cast<std::ptrdiff_t>(kLanes);
    value = select(from_bits(g.present[back].here), value, last);
  };
  replace(near.w, around.w);
  replace(near.n, around.n);
  replace(near.nw, around.nw);
  replace(near.ne, around.ne);
}

/// The energy of a low plane: residuals around, those of the first low plane here, and whether the
/// high half of its component changed, after which nothing predicts it.
GICODEC_INLINE I16 low_energy(const PlaneCoding& c, unsigned p, std::size_t at, I16 energy) {
  const unsigned first = static_cast<unsigned>(lowest_bit(c.group.low));
  I16 sum = shift_right<4>(energy);
  sum = sub(sum, shift_right<2>(sum));
  const I16 high = min_u(magnitude(load(c.residual + (p - 1) * c.plane_size + at)), set(3));
  sum = add(sum, shift_left<10>(high));
  if (p == first) return sum;
  return add(sum, shift_right<3>(magnitude(load(c.residual + first * c.plane_size + at))));
}

/// Scales of the texel's mantissas, by the exponents of the texel, its reference and those around.
GICODEC_INLINE void note_scales(const PlaneCoding& c, const Four& exponents, I16 reference,
                                I16 exponent, std::size_t at) {
  std::uint16_t* const to = c.scale + at;
  store(to, scale_of(reference, exponent));
  store(to + c.plane_size, scale_of(exponents.w, exponent));
  store(to + 2 * c.plane_size, scale_of(exponents.n, exponent));
  store(to + 3 * c.plane_size, scale_of(exponents.nw, exponent));
  store(to + 4 * c.plane_size, scale_of(exponents.ne, exponent));
}
GICODEC_INLINE Four scales_around(const PlaneCoding& c, std::size_t at) {
  const std::uint16_t* const from = c.scale + c.plane_size + at;
  return {load(from), load(from + c.plane_size), load(from + 2 * c.plane_size),
          load(from + 3 * c.plane_size)};
}

/// How the texels of a group are coded: all exist; some do not; they may repeat others. `kShared`:
/// the last plane may be an exponent. It costs compilers an instantiation more, and is worth that
/// where all texels exist.
enum class Texels { all, some, repeating };

template <bool kDecode, Texels kTexels, bool kShared, typename Coder>
GICODEC_INLINE void code_texel(const PlaneCoding& c, unsigned p, unsigned i, unsigned j,
                               Coder& coder) {
  constexpr bool kPartial = kTexels == Texels::some, kRepeats = kTexels == Texels::repeating;
  const Group& g = c.group;
  const Around near = around(g.width, i, j);
  const std::size_t texel = std::size_t{j} * g.width + i, at = texel * kLanes;
  const Present present = kPartial ? g.present[texel] : Present{g.active, 0};
  const unsigned bits = g.bits[p];
  const bool wide = is_wide(bits);
  const Weights& weights = c.weights[wide ? 1 : 0];
  std::uint16_t* const d = c.difference + p * c.plane_size;
  std::uint16_t* const r = c.residual + p * c.plane_size;
  Four ds = neighbours(d, near);
  if constexpr (kPartial) replace_absent(g, d + at, near, ds);
  const bool exponent = kShared && g.shared && p + 1 == g.planes;
  const bool mantissa = kShared && c.scaled && !exponent;
  I16 reference = load(g.reference + p * c.plane_size + at);
  if (mantissa) reference = scaled(reference, load(c.scale + at));
  I16 op = mantissa ? apply_scaled(weights, ds, scales_around(c, at))
           : wide   ? apply_wide(weights, ds)
                    : apply_narrow(weights, ds);
  Four rs = neighbours(r, near);
  if constexpr (kPartial) replace_absent(g, r + at, near, rs);
  LocalContext local = local_context(rs);
  const MagnitudeTables& magnitudes = wide ? kWideMagnitudes : kNarrowMagnitudes;
  I16 size;
  if (p == 0 || exponent) {
    size = near.first ? set(kFirstTexel) : magnitude_class(local.energy, magnitudes);
    if constexpr (kPartial) size = select(from_bits(present.before), size, set(kFirstTexel));
  } else if ((g.low >> p & 1) != 0) {
    size = near.first ? set(kFirstTexel)
                      : magnitude_class(low_energy(c, p, at, local.energy), magnitudes);
    if constexpr (kPartial) size = select(from_bits(present.before), size, set(kFirstTexel));
  } else {
    // The first two high planes at this texel were coded before.
    const I16 e0 = load(c.residual + at);
    op = add(op, apply_cross(weights, e0));
    I16 cross = magnitude(e0), energy = local.energy, votes = sign_of(e0);
    const unsigned second = (g.low & 2) != 0 ? 2 : 1;
    if (p > second) {
      const I16 e1 = load(c.residual + second * c.plane_size + at);
      cross = shift_right<1>(add_sat(add_sat(cross, magnitude(e1)), set(1)));
      votes = add(votes, sign_of(e1));
    } else {
      votes = add(votes, votes);
    }
    cross = add_sat(cross, cross);
    if (near.first) energy = add_sat(cross, cross);
    if constexpr (kPartial) {
      energy = select(from_bits(present.before), energy, add_sat(cross, cross));
    }
    size = magnitude_class(add_sat(sub(energy, shift_right<2>(energy)), cross), magnitudes);
    if (c.any_follows) follow(c.follows, votes, rs, local, size);
  }
  const I16 context = add(add(c.context_class, local.sign), size);
  I16 prediction = add(reference, op);
  if (mantissa) prediction = min_u(max_s(prediction, set(0)), set((1 << bits) - 1));
  I16 e = set(0);
  if constexpr (!kDecode) e = wrap(sub(load(g.current + p * c.plane_size + at), prediction), bits);
  const I16 choice = kRepeats ? load(c.choice + at) : set(0);
  const std::uint32_t open =
      kRepeats ? to_bits(equal(choice, set(kNoRepeat))) & g.active : present.here;
  if (kTexels == Texels::all || open != 0) {
    e = coder.token(place_of(p, g.low), p, context, open, local.flip, e);
  }
  I16 value = bit_and(add(prediction, e), set((1 << bits) - 1));
  if constexpr (kRepeats && kDecode) {
    value = select(from_bits(open), value, repeated_value(g, p * c.plane_size + at, choice));
    e = sub(value, prediction);
  }
  if constexpr (kDecode) {
    store(g.current + p * c.plane_size + at,
          kPartial ? keep(from_bits(present.here), value) : value);
    e = wrap(e, bits);  // a hostile stream may carry more than its bits
  }
  I16 difference = sub(value, reference);
  if constexpr (kPartial) {
    const M16 here = from_bits(present.here);
    difference = select(here, difference, last_before(d + at, near));
    e = select(here, e, last_before(r + at, near));
  }
  store(d + at, difference);
  store(r + at, e);
  if (!exponent) return;
  if constexpr (kPartial) {
    value = select(from_bits(present.here), value, last_before(c.exponent + at, near));
  }
  store(c.exponent + at, value);
  Four exponents = neighbours(c.exponent, near);
  if constexpr (kPartial) replace_absent(g, c.exponent + at, near, exponents);
  note_scales(c, exponents, reference, value, at);
}

/// Plane p is coded p texels behind plane 0, so that the symbols of a turn do not depend on each
/// other's residuals; a shared exponent goes first, since mantissas depend on it.
template <bool kDecode, Texels kTexels, bool kShared, typename Coder>
[[gnu::noinline]] bool code_planes(const Group& g, Coder& coder) {
  const std::size_t texels = std::size_t{g.width} * g.rows;
  const Mode* modes = g.update ? kPlaneUpdateModes : kPlaneKeyModes;
  PlaneCoding c{g,
                texels * kLanes,
                g.scratch,
                g.scratch + g.planes * texels * kLanes,
                {lane_weights(modes, g.mode[0], false), lane_weights(modes, g.mode[0], true)},
                lane_classes(modes, g.mode[0]),
                g.scratch + 2 * g.planes * texels * kLanes,
                g.scratch + (2 * g.planes + 1) * texels * kLanes,
                g.scratch + (2 * g.planes + 2) * texels * kLanes,
                g.scratch + (2 * g.planes + 3) * texels * kLanes,
                kShared && g.shared && (g.coded >> (g.planes - 1) & 1) != 0,
                {},
                false};
  if (g.update) {
    c.follows = equal(c.context_class, set(kFollowClass * kClassStep));
    c.any_follows = (to_bits(c.follows) & g.active) != 0;
  }
  for (unsigned p = 0; p < g.planes; ++p) {  // Other planes read some of these.
    if ((g.coded >> p & 1) != 0) continue;
    for (std::size_t k = 0; k < c.plane_size; k += kLanes)
      store(c.residual + p * c.plane_size + k, set(0));
  }
  unsigned first_i = 0, first_j = 0;  // of plane 0, also beyond the last row
  for (std::size_t turn = 0; turn + 1 < texels + g.planes; ++turn) {
    if (kTexels == Texels::repeating && turn < texels) {
      code_repeat<kDecode>(g, c.plane_size, c.matched, c.choice, first_i, first_j, coder);
    }
    unsigned i = first_i, j = first_j;
    for (unsigned k = 0; k < g.planes && k <= turn; ++k) {
      const unsigned p = !(kShared && g.shared) ? k : (k == 0 ? g.planes : k) - 1;
      if (j < g.rows && (g.coded >> p & 1) != 0)
        code_texel<kDecode, kTexels, kShared>(c, p, i, j, coder);
      if (i == 0) {
        i = g.width;
        --j;
      }
      --i;
    }
    if (!coder.ok()) return false;
    if (++first_i == g.width) {
      first_i = 0;
      ++first_j;
    }
  }
  return true;
}

template <bool kDecode, typename Coder>
GICODEC_INLINE bool code_any_planes(const Group& g, Coder& coder) {
  if (g.repeats) return code_planes<kDecode, Texels::repeating, false>(g, coder);
  if (g.present == nullptr) {
    return g.shared ? code_planes<kDecode, Texels::all, true>(g, coder)
                    : code_planes<kDecode, Texels::all, false>(g, coder);
  }
  return code_planes<kDecode, Texels::some, true>(g, coder);
}

Step* model_planes(const Group& g, Step* steps) {
  Modeller modeller{steps};
  code_any_planes<false>(g, modeller);
  return modeller.next;
}
bool decode_planes(const Group& g, const Tables& tables, Input& in) {
  Reader reader{tables, in};
  return code_any_planes<true>(g, reader);
}
