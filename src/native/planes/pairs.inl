// Pairs (two correlated 16-bit components): exact candidates first, residuals on escape. The first
// plane is m1, the second V = m2 − 2·m1.

struct Pair {
  I16 a, b;
};
GICODEC_INLINE Pair load_pair(const std::uint16_t* base, std::size_t plane_size,
                              std::ptrdiff_t at) {
  return {load(base + at), load(base + static_cast<std::ptrdiff_t>(plane_size) + at)};
}

/// Candidate scores as nibbles: candidates 0..3 in `low`, 4..6 in `high`.
struct Nibbles {
  I16 low, high;
};
GICODEC_INLINE I16 weigh(const Four& m) {  // 4·W + 3·N + 2·NE + NW, at most 10 in every nibble
  return add(add(shift_left<2>(m.w), add(shift_left<1>(m.n), m.n)), add(shift_left<1>(m.ne), m.nw));
}

/// The two best candidates of a texel's pair, and the context of the repeat symbol.
struct BestCandidates {
  Pair first, second;
  I16 context;
};
GICODEC_INLINE I16 nibble_of(const Nibbles& s, unsigned k) {
  const I16 fifteen = set(15);
  switch (k) {
    case 0:
      return bit_and(s.low, fifteen);
    case 1:
      return bit_and(shift_right<4>(s.low), fifteen);
    case 2:
      return bit_and(shift_right<8>(s.low), fifteen);
    case 3:
      return shift_right<12>(s.low);
    case 4:
      return bit_and(s.high, fifteen);
    case 5:
      return bit_and(shift_right<4>(s.high), fifteen);
    default:
      return shift_right<8>(s.high);
  }
}
GICODEC_INLINE BestCandidates rank_candidates(const Pair (&candidate)[kCandidates],
                                              const Nibbles& scores) {
  I16 score[kCandidates];
  GICODEC_UNROLL
  for (unsigned k = 0; k < kCandidates; ++k) score[k] = nibble_of(scores, k);
  BestCandidates g{candidate[0], candidate[0], set(0)};
  I16 best = score[0];
  GICODEC_UNROLL
  for (unsigned k = 1; k < kCandidates; ++k) {
    const M16 better = greater(score[k], best);
    best = max_s(best, score[k]);
    g.first = {select(better, candidate[k].a, g.first.a),
               select(better, candidate[k].b, g.first.b)};
  }
  I16 votes = set(-1), best2 = set(-1);  // the best candidate equals itself
  g.second = g.first;
  GICODEC_UNROLL
  for (unsigned k = 0; k < kCandidates; ++k) {
    const M16 same = mask_and(equal(candidate[k].a, g.first.a), equal(candidate[k].b, g.first.b));
    votes = add(votes, keep(same, set(1)));
    const M16 better = mask_andnot(greater(score[k], best2), same);
    best2 = select(better, score[k], best2);
    g.second = {select(better, candidate[k].a, g.second.a),
                select(better, candidate[k].b, g.second.b)};
  }
  g.context = add(add(shift_left<2>(best), best), min_u(votes, set(4)));
  return g;
}
/// Which candidates a pair repeats, one nibble each.
GICODEC_INLINE Nibbles matches(const Pair (&candidate)[kCandidates], const Pair& value) {
  Nibbles m{set(0), set(0)};
  GICODEC_UNROLL
  for (unsigned k = 0; k < kCandidates; ++k) {
    const M16 same = mask_and(equal(candidate[k].a, value.a), equal(candidate[k].b, value.b));
    I16& half = k < 4 ? m.low : m.high;
    half = bit_or(half, keep(same, set(1 << 4 * (k & 3))));
  }
  return m;
}

/// Reference and prediction of one plane at one texel.
struct PlanePrediction {
  I16 reference, prediction;
};

/// Keyframes: every mode predicts; the one with the least recent error is used.
struct KeyPredictor {
  std::uint16_t* difference[kModes];
  std::uint16_t* residual[kModes];
  Weights weights[kModes];
  I16 prediction[kModes];
  I16 reference[kModes];
};
/// The residuals that a mode left around: 2|W| + 2|N| + |NW| + |NE| + |WW| + |NN|, missing ones 0.
GICODEC_INLINE I16 recent_error(const std::uint16_t* r, const Around& near, unsigned width,
                                unsigned i, unsigned j, std::size_t at) {
  if (near.first) return set(0);
  const I16 w = magnitude(load(r + near.w)), n = magnitude(load(r + near.n));
  I16 sum = add_sat(w, n);
  sum = add_sat(add_sat(sum, sum),
                add_sat(magnitude(load(r + near.nw)), magnitude(load(r + near.ne))));
  if (i >= 2 && j > 0) sum = add_sat(sum, magnitude(load(r + at - 2 * kLanes)));
  if (j >= 2) sum = add_sat(sum, magnitude(load(r + at - 2 * width * std::size_t{kLanes})));
  return sum;
}

template <bool kDecode, typename Coder>
GICODEC_INLINE bool code_pairs(const Group& g, Coder& coder) {
  const std::size_t plane_size = std::size_t{g.width} * g.rows * kLanes;
  std::uint16_t* scratch = g.scratch;
  const auto take = [&scratch, plane_size] {
    std::uint16_t* p = scratch;
    scratch += plane_size;
    return p;
  };
  std::uint16_t* const match_low = take();
  std::uint16_t* const match_high = take();
  std::uint16_t* difference[2] = {take(), take()};
  std::uint16_t* residual[2] = {take(), take()};
  KeyPredictor key[2];
  Weights weights[2];
  I16 context_class[2];
  GICODEC_UNROLL
  for (unsigned p = 0; p < 2; ++p) {
    context_class[p] = set(0);
    if (g.update) {
      weights[p] = lane_weights(kPairUpdateModes[p], g.mode[p], true);
      context_class[p] = lane_classes(kPairUpdateModes[p], g.mode[p]);
      continue;
    }
    GICODEC_UNROLL
    for (unsigned m = 0; m < kModes; ++m) {
      key[p].difference[m] = take();
      key[p].residual[m] = take();
      key[p].weights[m] = uniform_weights(kPairKeyModes[p][m], true);
    }
  }
  const Pair frequent = {set(g.frequent[0]), set(g.frequent[1])};
  std::size_t at = 0;
  for (unsigned j = 0; j < g.rows; ++j) {
    for (unsigned i = 0; i < g.width; ++i, at += kLanes) {
      const Around near = around(g.width, i, j);
      const auto here = static_cast<std::ptrdiff_t>(at);
      Pair candidate[kCandidates];
      GICODEC_UNROLL
      for (unsigned k = 0; k < 4; ++k) candidate[k] = load_pair(g.candidate[k], plane_size, here);
      candidate[4] = near.first ? frequent : load_pair(g.current, plane_size, near.w);
      candidate[5] = near.first ? frequent : load_pair(g.current, plane_size, near.n);
      candidate[6] = frequent;
      const BestCandidates candidates = rank_candidates(
          candidate, {weigh(neighbours(match_low, near)), weigh(neighbours(match_high, near))});

      PlanePrediction predicted[2];
      GICODEC_UNROLL
      for (unsigned p = 0; p < 2; ++p) {
        PlanePrediction& f = predicted[p];
        if (g.update) {
          f.reference = load(g.reference + p * plane_size + at);
          f.prediction = add(f.reference, apply_wide(weights[p], neighbours(difference[p], near)));
          continue;
        }
        I16 least = set(0);
        GICODEC_UNROLL
        for (unsigned m = 0; m < kModes; ++m) {
          const Mode& mode = kPairKeyModes[p][m];
          const Pair* from = mode.reference == Reference::frequent ? &frequent
                             : mode.reference == Reference::neighbours
                                 ? &candidate[mode.neighbours == kX   ? 1
                                              : mode.neighbours == kY ? 2
                                                                      : 3]
                                 : nullptr;
          const I16 reference = from == nullptr ? set(0) : p == 0 ? from->a : from->b;
          key[p].reference[m] = reference;
          key[p].prediction[m] =
              add(reference, apply_wide(key[p].weights[m], neighbours(key[p].difference[m], near)));
          // Compared as signed: half of the sum keeps the order.
          const I16 left =
              shift_right<1>(recent_error(key[p].residual[m], near, g.width, i, j, at));
          if (m == 0) {
            least = left;
            f.prediction = key[p].prediction[0];
          } else {
            f.prediction = select(greater(least, left), key[p].prediction[m], f.prediction);
            least = select(greater(least, left), left, least);
          }
        }
      }

      // The texel is the best candidate, the second-best, or two residuals.
      Pair value = candidates.first;
      I16 symbol = set(0);
      if constexpr (!kDecode) {
        value = load_pair(g.current, plane_size, here);
        const M16 is1 =
            mask_and(equal(value.a, candidates.first.a), equal(value.b, candidates.first.b));
        const M16 is2 =
            mask_and(equal(value.a, candidates.second.a), equal(value.b, candidates.second.b));
        symbol = select(is1, set(0), select(is2, set(1), set(2)));
      }
      symbol = coder.repeat(candidates.context, g.active, symbol);
      const std::uint32_t escaped = to_bits(equal(symbol, set(2))) & g.active;
      if constexpr (kDecode) {
        const M16 second = equal(symbol, set(1));
        value = {select(second, candidates.second.a, candidates.first.a),
                 select(second, candidates.second.b, candidates.first.b)};
      }
      if (escaped != 0) {
        const M16 open = from_bits(escaped);
        const LocalContext l0 = local_context(neighbours(residual[0], near));
        I16 size = near.first ? set(kFirstTexel) : magnitude_class(l0.energy, kWideMagnitudes);
        I16 e = coder.token(0, 0, add(context_class[0], add(l0.sign, size)), escaped, l0.flip,
                            sub(value.a, predicted[0].prediction));
        value.a = select(open, add(predicted[0].prediction, e), value.a);
        const I16 a0 = magnitude(e);
        const LocalContext l1 = local_context(neighbours(residual[1], near));
        const I16 cross = add_sat(a0, add_sat(a0, a0));
        size = magnitude_class(shift_right<1>(add_sat(l1.energy, cross)), kWideMagnitudes);
        e = coder.token(1, 1, add(context_class[1], add(l1.sign, size)), escaped, l1.flip,
                        sub(value.b, predicted[1].prediction));
        value.b = select(open, add(predicted[1].prediction, e), value.b);
      }
      if constexpr (kDecode) {
        store(g.current + at, value.a);
        store(g.current + plane_size + at, value.b);
      }

      // State for later texels, the same for repeats and escapes.
      const Nibbles matched = matches(candidate, value);
      store(match_low + at, matched.low);
      store(match_high + at, matched.high);
      GICODEC_UNROLL
      for (unsigned p = 0; p < 2; ++p) {
        const I16 v = p == 0 ? value.a : value.b;
        store(residual[p] + at, sub(v, predicted[p].prediction));
        if (g.update) {
          store(difference[p] + at, sub(v, predicted[p].reference));
          continue;
        }
        GICODEC_UNROLL
        for (unsigned m = 0; m < kModes; ++m) {
          store(key[p].difference[m] + at, sub(v, key[p].reference[m]));
          store(key[p].residual[m] + at, sub(v, key[p].prediction[m]));
        }
      }
      if (!coder.ok()) return false;
    }
  }
  return true;
}

Step* model_pairs(const Group& g, Step* steps) {
  Modeller modeller{steps};
  code_pairs<false>(g, modeller);
  return modeller.next;
}
bool decode_pairs(const Group& g, const Tables& tables, Input& in) {
  Reader reader{tables, in};
  return code_pairs<true>(g, reader);
}
