// Tokens and raw bits → values of a block.

/// The folded residuals of small tokens; 0 for others.
struct DigitTables {
  std::uint8_t of[kMaxGroupPlanes][kMaxTokens];
};
constexpr DigitTables digit_tables(unsigned planes) {
  DigitTables tables{};
  unsigned small = 1;
  for (unsigned i = 0; i < planes; ++i) small *= 3;
  for (unsigned t = 0; t < small; ++t) {
    unsigned rest = t;
    for (unsigned i = planes; i-- > 0; rest /= 3) {
      tables.of[i][t] = static_cast<std::uint8_t>(rest % 3);
    }
  }
  return tables;
}
template <unsigned kPlanes>
inline constexpr DigitTables kDigits = digit_tables(kPlanes);

GICODEC_INLINE I16 unfolded(I16 value) {
  return bit_xor(shift_right<1>(value), sub(set(0), bit_and(value, set(1))));
}

/// The inverse of a texel's put().
template <unsigned kPlanes>
GICODEC_INLINE void take(BitSource& source, unsigned c, unsigned l,
                         std::uint16_t (&values)[kPlanes][kLanes]) {
  const unsigned rest = c == 16 ? c : c - 1;
  std::uint64_t bits = read<std::uint64_t>(source.bytes + (source.at >> 3)) >> (source.at & 7);
  values[0][l] = static_cast<std::uint16_t>(bits & ((1U << c) - 1));
  bits >>= c;
  for (unsigned i = 1; i < kPlanes; ++i, bits >>= rest) {
    values[i][l] = static_cast<std::uint16_t>(bits & ((1U << rest) - 1));
  }
  source.at += c + (kPlanes - 1) * rest;
}

/// Residuals of a block; where it copies, which texels, and their differences.
template <unsigned kPlanes>
GICODEC_INLINE void read_residuals(const TokenGroup& group, const TokenBlock& block,
                                   const std::uint8_t* tokens, BitSource& source,
                                   const Arrays& array) {
  const unsigned base = group.base();
  alignas(64) std::uint16_t values[kPlanes][kLanes];
  for (unsigned t = 0; t < block.texels; t += kLanes) {
    const B8 token = load_bytes(tokens + t);
    const I16 number = words(token);
    I16 value[kPlanes];
    for (unsigned i = 0; i < kPlanes; ++i)
      value[i] = words(lookup64(kDigits<kPlanes>.of[i], token));
    std::uint32_t raw = to_bits(greater(number, set(static_cast<int>(base + 1))));
    if (block.texels - t < kLanes) raw &= (1U << (block.texels - t)) - 1;
    if (raw != 0) {
      for (unsigned i = 0; i < kPlanes; ++i) store(values[i], value[i]);
      for (; raw != 0; raw &= raw - 1) {
        const auto l = static_cast<unsigned>(std::countr_zero(raw));
        take<kPlanes>(source, tokens[t + l] - base, l, values);
      }
      for (unsigned i = 0; i < kPlanes; ++i) value[i] = load(values[i]);
    }
    for (unsigned i = 0; i < kPlanes; ++i) store(array[i] + t, unfolded(value[i]));
    if (group.copies == 0) continue;
    M16 any = greater(set(0), set(0));
    I16 copied[kPlanes];
    for (unsigned i = 0; i < kPlanes; ++i) copied[i] = set(0);
    for (unsigned k = 0; k < kCopies; ++k) {
      const M16 here = equal(number, set(static_cast<int>(group.small + k)));
      any = mask_or(any, here);
      for (unsigned i = 0; i < kPlanes; ++i)
        copied[i] = select(here, load(block.copy[k][i] + t), copied[i]);
    }
    store(array[2 * kPlanes] + t, keep(any, set(-1)));
    for (unsigned i = 0; i < kPlanes; ++i) {
      store(array[kPlanes + i] + t, sub(copied[i], load(block.reference[i] + t)));
    }
  }
}

template <unsigned kPlanes>
GICODEC_INLINE void read_group(const TokenGroup& group, const TokenBlock& block,
                               const std::uint8_t* tokens, BitSource& source,
                               std::uint16_t* const* planes) {
  const Arrays array = arrays_of(block);
  for (unsigned i = 0; i < kPlanes; ++i) set_row_before(group, block, i, array[i]);
  read_residuals<kPlanes>(group, block, tokens, source, array);
  const std::uint16_t* const is_copy = array[2 * kPlanes];
  for (unsigned i = 0; i < kPlanes; ++i) {
    std::uint16_t* const at = array[i];
    const std::uint16_t* const copied = array[kPlanes + i];
    switch (group.prediction) {
      case TokenPrediction::none:
        if (group.copies != 0) copy_texels(at, is_copy, copied, block);
        break;
      case TokenPrediction::north:
        group.copies != 0 ? add_rows(at, is_copy, copied, block) : add_rows(at, block);
        break;
      case TokenPrediction::west:  // what column 0 has, the sums along rows bring to all others
        add_first_column(at, block);
        add_columns(at, block);
        break;
      case TokenPrediction::gradient:
        add_columns(at, block);
        add_rows(at, block);
        break;
    }
  }
  for (unsigned t = 0; t < block.texels; t += kLanes) {
    const I16 first = load(array[0] + t);
    for (unsigned i = 0; i < kPlanes; ++i) {
      I16 difference = load(array[i] + t);
      if (i > 0 && group.follows) difference = add(difference, first);
      const I16 value = add(load(block.reference[i] + t), difference);
      store(planes[i] + t, bit_and(value, mask_of(group.bits[i])));
    }
  }
}

void read_tokens(const TokenGroup& group, const TokenBlock& block, const std::uint8_t* tokens,
                 BitSource& source, std::uint16_t* const* planes) {
  switch (group.planes) {
    case 1:
      return read_group<1>(group, block, tokens, source, planes);
    case 2:
      return read_group<2>(group, block, tokens, source, planes);
    default:
      return read_group<3>(group, block, tokens, source, planes);
  }
}
