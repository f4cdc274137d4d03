// Differences of a group's planes to their reference, as arrays with a row before them, and their
// predictions from the texels at N, W and NW.

/// Arrays of the scratch memory, each with a row before it.
struct Arrays {
  std::uint16_t* first;
  std::size_t step;
  std::uint16_t* operator[](unsigned i) const { return first + i * step; }
};
GICODEC_INLINE Arrays arrays_of(const TokenBlock& block) {
  return {block.scratch + 1 + block.width, block.width + block.stride};
}
/// The row of differences that plane `i` continues, or zeros.
GICODEC_INLINE void set_row_before(const TokenGroup& group, const TokenBlock& block, unsigned i,
                                   std::uint16_t* array) {
  std::uint16_t* const row = array - block.width;
  if (block.before[i] == nullptr) {
    std::memset(row, 0, std::size_t{2} * block.width);
    return;
  }
  for (unsigned x = 0; x < block.width; ++x) {
    const unsigned first = i > 0 && group.follows ? block.before[0][x] : 0;
    row[x] = static_cast<std::uint16_t>(block.before[i][x] - first);
  }
}

/// Bits of a plane as a mask.
GICODEC_INLINE I16 mask_of(unsigned bits) { return set((1 << bits) - 1); }

/// What a difference is predicted from. Column 0 has no W: it takes N.
GICODEC_INLINE I16 predicted(TokenPrediction prediction, const std::uint16_t* at,
                             const TokenBlock& block, unsigned t) {
  if (prediction == TokenPrediction::none) return set(0);
  const I16 north = load(at - block.width);
  if (prediction == TokenPrediction::north) return north;
  const I16 inner = load(block.columns + t), west = load(at - 1);
  if (prediction == TokenPrediction::west)
    return bit_xor(north, bit_and(inner, bit_xor(west, north)));
  return add(north, bit_and(inner, sub(west, load(at - 1 - block.width))));
}

/// Adds to each row the one above; the compiler knows the width of most.
template <unsigned kWidth>
GICODEC_INLINE void add_rows_of(std::uint16_t* at, unsigned width, unsigned texels) {
  const unsigned w = kWidth != 0 ? kWidth : width;
  for (unsigned row = 0; row < texels; row += w) {
    std::uint16_t* const here = at + row;
    for (unsigned x = 0; x < w; ++x) {
      here[x] = static_cast<std::uint16_t>(here[x] + *(here + x - w));
    }
  }
}
/// The same, but for texels that are copies, which have differences of their own.
template <unsigned kWidth>
GICODEC_INLINE void add_rows_of(std::uint16_t* at, const std::uint16_t* is_copy,
                                const std::uint16_t* copied, unsigned width, unsigned texels) {
  const unsigned w = kWidth != 0 ? kWidth : width;
  for (unsigned row = 0; row < texels; row += w) {
    std::uint16_t* const here = at + row;
    for (unsigned x = 0; x < w; ++x) {
      const auto sum = static_cast<std::uint16_t>(here[x] + *(here + x - w));
      const std::uint16_t mask = is_copy[row + x];
      here[x] = static_cast<std::uint16_t>((sum & ~mask) | (copied[row + x] & mask));
    }
  }
}
GICODEC_INLINE void add_rows(std::uint16_t* at, const TokenBlock& block) {
  block.width == 16  ? add_rows_of<16>(at, block.width, block.texels)
  : block.width == 8 ? add_rows_of<8>(at, block.width, block.texels)
                     : add_rows_of<0>(at, block.width, block.texels);
}
GICODEC_INLINE void add_rows(std::uint16_t* at, const std::uint16_t* is_copy,
                             const std::uint16_t* copied, const TokenBlock& block) {
  block.width == 16  ? add_rows_of<16>(at, is_copy, copied, block.width, block.texels)
  : block.width == 8 ? add_rows_of<8>(at, is_copy, copied, block.width, block.texels)
                     : add_rows_of<0>(at, is_copy, copied, block.width, block.texels);
}
GICODEC_INLINE void copy_texels(std::uint16_t* at, const std::uint16_t* is_copy,
                                const std::uint16_t* copied, const TokenBlock& block) {
  for (unsigned t = 0; t < block.texels; t += kLanes) {
    const I16 mask = load(is_copy + t), own = load(at + t);
    store(at + t, bit_xor(own, bit_and(mask, bit_xor(own, load(copied + t)))));
  }
}
/// Sums down column 0.
GICODEC_INLINE void add_first_column(std::uint16_t* at, const TokenBlock& block) {
  std::uint16_t above = *(at - block.width);
  for (unsigned row = 0; row < block.texels; row += block.width) {
    above = at[row] = static_cast<std::uint16_t>(at[row] + above);
  }
}
/// Sums along rows.
GICODEC_INLINE void add_columns(std::uint16_t* at, const TokenBlock& block) {
  if (block.width == 8) {
    for (unsigned t = 0; t < block.texels; t += kLanes) {
      I16 row = load(at + t);
      row = add(row, up<1>(row));
      row = add(row, up<2>(row));
      store(at + t, add(row, up<4>(row)));
    }
    return;
  }
  const std::uint16_t* inner = block.columns;
  for (unsigned s = 1; s < block.width; s *= 2, inner += block.stride) {
    for (unsigned t = (block.texels - 1) / kLanes * kLanes;; t -= kLanes) {
      store(at + t, add(load(at + t), bit_and(load(at + t - s), load(inner + t))));
      if (t == 0) break;
    }
  }
}
