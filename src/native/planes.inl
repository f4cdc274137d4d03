// Integer planes (colour and all generic formats): one mode per block for all planes.

/// Sign extension of a difference of values of `bits` bits.
inline I16 wrap(I16 a, unsigned bits) {
  switch (bits) {
    case 2: return shift_arithmetic<14>(shift_left<14>(a));
    case 5: return shift_arithmetic<11>(shift_left<11>(a));
    case 8: return shift_arithmetic<8>(shift_left<8>(a));
    case 9: return shift_arithmetic<7>(shift_left<7>(a));
    case 10: return shift_arithmetic<6>(shift_left<6>(a));
    case 11: return shift_arithmetic<5>(shift_left<5>(a));
    default: return a;
  }
}
inline bool is_wide(unsigned bits) { return bits > 11; }

template <bool kDecode, typename Coder>
inline bool code_planes(const Group& g, Coder& coder) {
  const std::size_t texels = std::size_t{g.core} * g.core;
  const std::size_t plane_size = texels * kLanes;
  const Mode* modes = g.update ? kPlaneUpdateModes : kPlaneKeyModes;
  std::uint16_t* const difference = g.scratch;              // [plane][texel][lane]
  std::uint16_t* const residual = g.scratch + g.planes * plane_size;
  const Weights narrow_weights = lane_weights(modes, g.mode[0], false);
  const Weights wide_weights = lane_weights(modes, g.mode[0], true);
  const I16 mode_offset = mul_lo(load(g.mode[0]), set(kRowSize));
  std::size_t at = 0;
  for (unsigned j = 0; j < g.core; ++j) {
    for (unsigned i = 0; i < g.core; ++i, at += kLanes) {
      const Around near = around(g.core, i, j);
      I16 e0 = set(0), a0 = e0, a1 = e0;
      for (unsigned p = 0; p < g.planes; ++p) {
        if (!(g.coded >> p & 1)) continue;
        const unsigned bits = g.bits[p];
        const bool wide = is_wide(bits);
        const Weights& weights = wide ? wide_weights : narrow_weights;
        std::uint16_t* const d = difference + p * plane_size;
        std::uint16_t* const r = residual + p * plane_size;
        const Four ds = neighbours(d, near);
        I16 op = wide ? apply_wide(weights, ds) : apply_narrow(weights, ds);
        const Local local = look_around(neighbours(r, near));
        I16 energy = local.energy;
        I16 klass;
        if (p > 0) {
          op = add(op, apply_cross(weights, e0));
          const I16 c = p == 1 ? a0 : shift_right<1>(add_sat(add_sat(a0, a1), set(1)));
          const I16 c2 = add_sat(c, c);
          if (near.first) energy = add_sat(c2, c2);
          klass = magnitude_class(add_sat(sub(energy, shift_right<2>(energy)), c2));
        } else {
          klass = near.first ? set(kFirstTexel) : magnitude_class(energy);
        }
        const I16 base = add(set(static_cast<int>(plane_row(g.update, p, 0) * kRowSize)), mode_offset);
        const I16 context = add(add(base, local.sign_class), klass);
        const I16 reference = load(g.reference + p * plane_size + at);
        const I16 prediction = add(reference, op);
        I16 e = set(0);
        if constexpr (!kDecode) {
          e = wrap(sub(load(g.current + p * plane_size + at), prediction), bits);
        }
        e = coder.token(context, g.active, local.flip, e);
        const I16 value = bit_and(add(prediction, e), set((1 << bits) - 1));
        if constexpr (kDecode) store(g.current + p * plane_size + at, value);
        // A hostile stream may carry residuals out of range: wrap as the encoder does.
        if constexpr (kDecode) e = wrap(e, bits);
        store(d + at, sub(value, reference));
        store(r + at, e);
        if (p == 0) {
          e0 = e;
          a0 = magnitude(e);
        } else if (p == 1) {
          a1 = magnitude(e);
        }
      }
      if (!coder.ok()) return false;
    }
  }
  return true;
}

Step* model_planes(const Group& g, Step* steps) {
  Modeller modeller{steps};
  code_planes<false>(g, modeller);
  return modeller.next;
}
bool decode_planes(const Group& g, const Tables& tables, Input& in) {
  Reader reader{tables, in};
  return code_planes<true>(g, reader);
}
