// Residuals of a block → tokens and raw bits.

/// Residuals of so many bits, signed → 0, 2, 4, … for those that are not negative, 1, 3, 5, … for
/// others.
GICODEC_INLINE I16 folded(I16 residual, unsigned bits) {
  const I16 mask = mask_of(bits), value = bit_and(residual, mask);
  const I16 sign = sub(set(0), shift_right_all(value, bits - 1));
  return bit_and(bit_xor(shift_left<1>(value), sign), mask);
}

struct WidthTables {
  NibbleTable nibble[4];
};
constexpr WidthTables width_tables() {
  WidthTables tables{};
  for (unsigned n = 0; n < 4; ++n) {
    for (unsigned i = 1; i < 16; ++i) {
      tables.nibble[n].entry[i] = static_cast<std::uint8_t>(4 * n + std::bit_width(i));
    }
  }
  return tables;
}
inline constexpr WidthTables kWidths = width_tables();
GICODEC_INLINE I16 width_of(I16 v) {
  const I16 low = set(15);
  const I16 a = max_s(lookup16(kWidths.nibble[0], bit_and(v, low)),
                      lookup16(kWidths.nibble[1], bit_and(shift_right<4>(v), low)));
  const I16 b = max_s(lookup16(kWidths.nibble[2], bit_and(shift_right<8>(v), low)),
                      lookup16(kWidths.nibble[3], shift_right<12>(v)));
  return max_s(a, b);
}

GICODEC_INLINE void put(BitSink& sink, std::uint64_t value, unsigned bits) {
  sink.bits |= value << sink.count;
  sink.count += bits;
  write(sink.next, sink.bits);
  sink.next += sink.count >> 3;
  sink.bits >>= sink.count & ~7U;
  sink.count &= 7;
}

template <unsigned kPlanes>
GICODEC_INLINE void write_group(const TokenGroup& group, const TokenBlock& block,
                                std::uint8_t* tokens, BitSink& sink) {
  const Arrays difference = arrays_of(block);
  const bool predicts = group.prediction != TokenPrediction::none;
  for (unsigned i = 0; i < kPlanes; ++i) set_row_before(group, block, i, difference[i]);
  for (unsigned t = 0; t < block.texels; t += kLanes) {
    const I16 first = sub(load(block.current[0] + t), load(block.reference[0] + t));
    store(difference[0] + t, first);
    for (unsigned i = 1; i < kPlanes; ++i) {
      const I16 own = sub(load(block.current[i] + t), load(block.reference[i] + t));
      store(difference[i] + t, group.follows ? sub(own, first) : own);
    }
  }
  const unsigned base = group.base();
  const I16 zero = set(0), one = set(1), two = set(2);
  alignas(64) std::uint16_t values[kPlanes][kLanes];
  for (unsigned t = 0; t < block.texels; t += kLanes) {
    M16 small = equal(zero, zero);
    I16 token = zero, largest = zero;
    for (unsigned i = 0; i < kPlanes; ++i) {
      const std::uint16_t* const at = difference[i] + t;
      I16 residual = load(at);
      if (predicts) residual = sub(residual, predicted(group.prediction, at, block, t));
      const I16 value = folded(residual, group.bits[i]);
      store(values[i], value);
      small = mask_and(small, equal(min_u(value, two), value));
      token = add(add(token, add(token, token)), value);
      const I16 own = i == 0 ? value : add_sat(add_sat(value, value), one);
      largest = add(largest, sub(own, min_u(largest, own)));
    }
    const M16 is_zero = mask_and(small, equal(token, zero));
    token = select(small, token, add(width_of(largest), set(static_cast<int>(base))));
    if (group.copies != 0) {
      for (unsigned k = kCopies; k-- > 0;) {
        M16 same = equal(zero, zero);
        for (unsigned i = 0; i < kPlanes; ++i) {
          same = mask_and(same, equal(load(block.current[i] + t), load(block.copy[k][i] + t)));
        }
        token = select(same, set(static_cast<int>(group.small + k)), token);
      }
      token = select(is_zero, zero, token);
    }
    store(tokens + t, bytes(token));
    std::uint32_t raw = to_bits(greater(token, set(static_cast<int>(base + 1))));
    if (block.texels - t < kLanes) raw &= (1U << (block.texels - t)) - 1;
    for (; raw != 0; raw &= raw - 1) {
      const auto l = static_cast<unsigned>(std::countr_zero(raw));
      const unsigned c = tokens[t + l] - base, rest = c == 16 ? c : c - 1;
      std::uint64_t bits = values[0][l];
      for (unsigned i = 1; i < kPlanes; ++i) {
        bits |= std::uint64_t{values[i][l]} << (c + (i - 1) * rest);
      }
      put(sink, bits, c + (kPlanes - 1) * rest);
    }
  }
}

void write_tokens(const TokenGroup& group, const TokenBlock& block, std::uint8_t* tokens,
                  BitSink& sink) {
  switch (group.planes) {
    case 1:
      return write_group<1>(group, block, tokens, sink);
    case 2:
      return write_group<2>(group, block, tokens, sink);
    default:
      return write_group<3>(group, block, tokens, sink);
  }
}
