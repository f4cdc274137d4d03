// Interleaved triples of bytes ↔ three planes, 16 samples at a time, for sets with
// shuffle_bytes(register, control): 16 bytes by index, 0 for controls above 127. Byte16 is the
// register.

struct Shuffle3 {
  alignas(16) std::uint8_t control[3][3][16];  ///< [to][from][place]
};
constexpr Shuffle3 make_shuffle3(bool split) {
  Shuffle3 table{};
  for (int to = 0; to < 3; ++to) {
    for (int from = 0; from < 3; ++from) {
      for (int i = 0; i < 16; ++i) {
        const int at = split ? 3 * i + to - 16 * from : 16 * to + i;
        const int place = split ? at : at / 3;
        const bool here = split ? at >= 0 && at < 16 : at % 3 == from;
        table.control[to][from][i] = static_cast<std::uint8_t>(here ? place : 0x80);
      }
    }
  }
  return table;
}
inline constexpr Shuffle3 kSplit3 = make_shuffle3(true), kJoin3 = make_shuffle3(false);
GICODEC_INLINE void shuffle3(const std::uint8_t* const (&from)[3], const Shuffle3& table,
                             std::uint8_t* const (&to)[3]) {
  const Byte16 a = load16(from[0]), b = load16(from[1]), c = load16(from[2]);
  for (int out = 0; out < 3; ++out) {
    const auto& control = table.control[out];
    store16(to[out],
            or16(or16(shuffle_bytes(a, load16(control[0])), shuffle_bytes(b, load16(control[1]))),
                 shuffle_bytes(c, load16(control[2]))));
  }
}
inline constexpr std::size_t kTriples = 16;
GICODEC_INLINE void split3(const std::uint8_t* from, std::uint8_t* const (&planes)[3]) {
  shuffle3({from, from + 16, from + 32}, kSplit3, planes);
}
GICODEC_INLINE void join3(const std::uint8_t* const (&planes)[3], std::uint8_t* to) {
  shuffle3(planes, kJoin3, {to, to + 16, to + 32});
}
