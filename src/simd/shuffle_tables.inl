// Where words go when some of four lanes take them in or put them out, for byte shuffles that give
// 0 for controls of 0x80.

struct ShuffleTables {
  std::uint8_t spread[16][16];  ///< dword k of a load to the k-th set bit
  std::uint8_t bytes[16];       ///< two per set bit
  std::uint8_t gather[16][16];  ///< low words of set lanes, packed to the top of 8 bytes
};
constexpr ShuffleTables make_shuffles() {
  ShuffleTables t{};
  for (unsigned m = 0; m < 16; ++m) {
    unsigned k = 0;
    for (unsigned l = 0; l < 4; ++l) {
      const bool set = m >> l & 1;
      for (unsigned b = 0; b < 4; ++b) {
        t.spread[m][4 * l + b] = set && b < 2 ? static_cast<std::uint8_t>(2 * k + b) : 0x80;
      }
      k += set;
    }
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
