// Repeats (docs/native.md, "Repeats"): records of many planes that equal those of the mirror or of
// a neighbouring block.

constexpr unsigned kNoRepeat = kBlockCandidates;  ///< choice of a texel that repeats nothing

/// A candidate of all lanes: a bit of every nibble for the candidates that it equals, and its
/// number.
struct Repeated {
  I16 equal_to, number;
};
GICODEC_INLINE I16 bit_of(unsigned k) { return set(1 << 4 * k); }
/// Whether two texels of a group are the same in all planes that are coded.
GICODEC_INLINE M16 same_texel(const Group& g, std::size_t plane_size, const std::uint16_t* a,
                              const std::uint16_t* b) {
  M16 same = equal(set(0), set(0));
  for (unsigned p = 0; p < g.planes; ++p, a += plane_size, b += plane_size) {
    if ((g.coded >> p & 1) != 0) same = mask_and(same, equal(load(a), load(b)));
  }
  return same;
}

/// Codes which candidate the texel repeats, or none, and notes that in `matched` and `choice`.
template <bool kDecode, typename Coder>
GICODEC_INLINE void code_repeat(const Group& g, std::size_t plane_size, std::uint16_t* matched,
                                std::uint16_t* choice, unsigned i, unsigned j, Coder& coder) {
  const Around near = around(g.width, i, j);
  const std::size_t at = (std::size_t{j} * g.width + i) * kLanes;
  Repeated candidate[kBlockCandidates];
  for (unsigned k = 0; k < kBlockCandidates; ++k) {
    candidate[k] = {bit_of(k), set(static_cast<int>(k))};
  }
  for (unsigned k = 0; k < kBlockCandidates; ++k) {
    for (unsigned l = k + 1; l < kBlockCandidates; ++l) {
      const M16 same = same_texel(g, plane_size, g.candidate[k] + at, g.candidate[l] + at);
      candidate[k].equal_to = bit_or(candidate[k].equal_to, keep(same, bit_of(l)));
      candidate[l].equal_to = bit_or(candidate[l].equal_to, keep(same, bit_of(k)));
    }
  }
  const Nibbles scores{weigh(neighbours(matched, near)), set(0)};
  Repeated first = candidate[0];
  I16 best = nibble_of(scores, 0);
  for (unsigned k = 1; k < kBlockCandidates; ++k) {
    const I16 score = nibble_of(scores, k);
    const M16 better = greater(score, best);
    best = max_s(best, score);
    first = {select(better, candidate[k].equal_to, first.equal_to),
             select(better, candidate[k].number, first.number)};
  }
  Repeated second = first;
  I16 votes = set(-1), best2 = set(-1);
  for (unsigned k = 0; k < kBlockCandidates; ++k) {
    const I16 score = nibble_of(scores, k);
    const M16 same = equal(bit_and(first.equal_to, bit_of(k)), bit_of(k));
    votes = add(votes, keep(same, set(1)));
    const M16 better = mask_andnot(greater(score, best2), same);
    best2 = select(better, score, best2);
    second = {select(better, candidate[k].equal_to, second.equal_to),
              select(better, candidate[k].number, second.number)};
  }
  I16 symbol = set(0);
  if constexpr (!kDecode) {
    I16 mine = set(0);
    for (unsigned k = 0; k < kBlockCandidates; ++k) {
      const M16 same = same_texel(g, plane_size, g.candidate[k] + at, g.current + at);
      mine = bit_or(mine, keep(same, bit_of(k)));
    }
    symbol = select(equal(mine, first.equal_to), set(0),
                    select(equal(mine, second.equal_to), set(1), set(2)));
  }
  const I16 context = add(add(shift_left<2>(best), best), votes);
  symbol = coder.repeat(context, g.active, symbol);
  const M16 is0 = equal(symbol, set(0)), is1 = equal(symbol, set(1));
  store(matched + at, select(is0, first.equal_to, keep(is1, second.equal_to)));
  store(choice + at, select(is0, first.number, select(is1, second.number, set(kNoRepeat))));
}

/// One plane of what a texel repeats; anything where it repeats nothing.
GICODEC_INLINE I16 repeated_value(const Group& g, std::size_t at, I16 choice) {
  I16 value = load(g.candidate[0] + at);
  for (unsigned k = 1; k < kBlockCandidates; ++k) {
    value = select(equal(choice, set(static_cast<int>(k))), load(g.candidate[k] + at), value);
  }
  return value;
}
