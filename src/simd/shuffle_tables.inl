// Byte shuffles of refill() and spill(), for four lanes: where words go. A control of 0x80 gives 0.

struct ShuffleTables {
  std::uint8_t bytes[16];       ///< two per set bit
  std::uint8_t gather[16][16];  ///< low words of set lanes, packed to the top of 8 bytes
};
constexpr ShuffleTables make_shuffles() {
  ShuffleTables t{};
  for (unsigned m = 0; m < 16; ++m) {
    const auto k = static_cast<unsigned>(std::popcount(m));
    t.bytes[m] = static_cast<std::uint8_t>(2 * k);
    unsigned at = 4 - k;
    for (unsigned b = 0; b < 16; ++b) t.gather[m][b] = 0x80;
    for (unsigned l = 0; l < 4; ++l) {
      if (!(m >> l & 1)) continue;
      t.gather[m][2 * at] = static_cast<std::uint8_t>(4 * l);
      t.gather[m][2 * at + 1] = static_cast<std::uint8_t>(4 * l + 1);
      ++at;
    }
  }
  return t;
}
alignas(16) inline constexpr ShuffleTables kShuffles = make_shuffles();

/// The loaded word of each of eight lanes: word k goes to the k-th set bit.
struct SpreadTable {
  std::uint8_t words[256][16];
};
constexpr SpreadTable make_spread() {
  SpreadTable t{};
  for (unsigned m = 0; m < 256; ++m) {
    unsigned k = 0;
    for (unsigned l = 0; l < 8; ++l) {
      const bool set = m >> l & 1;
      for (unsigned b = 0; b < 2; ++b) {
        t.words[m][2 * l + b] = set ? static_cast<std::uint8_t>(2 * k + b) : 0x80;
      }
      k += set;
    }
  }
  return t;
}
alignas(64) inline constexpr SpreadTable kSpread = make_spread();
