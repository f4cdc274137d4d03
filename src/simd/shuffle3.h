// Three bytes in turn ↔ three planes, 16 or 64 samples at a time, by byte shuffles. Part of
// kernels.inl: compiled per instruction set, internal linkage. Each returns how many samples it
// did.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__SSSE3__)
#include <immintrin.h>
#endif

namespace gicodec::GICODEC_ISA {
namespace {

#if defined(__AVX512VBMI__)

/// 64 byte indices into three registers: one permutation of the first two, one of the third, which
/// replaces the bytes in `mask`.
struct Permute3 {
  alignas(64) std::uint8_t index[3][64];  // 0-63 and 64-127: the first two; then the third's 0-63
  std::uint64_t mask[3];
};
constexpr Permute3 make_permute3(bool split) {
  Permute3 table{};
  for (int out = 0; out < 3; ++out) {
    for (int i = 0; i < 64; ++i) {
      // Split: plane `out` of bytes in turn. Join: byte 64·out + i of bytes in turn.
      const int at = 64 * out + i;
      const int from = split ? 3 * i + out : at % 3 * 64 + at / 3;
      table.index[out][i] = static_cast<std::uint8_t>(from < 128 ? from : from - 128);
      if (from >= 128) table.mask[out] |= std::uint64_t{1} << i;
    }
  }
  return table;
}
constexpr Permute3 kSplit3 = make_permute3(true);
constexpr Permute3 kJoin3 = make_permute3(false);

inline void permute3(const void* const (&from)[3], const Permute3& table, void* const (&to)[3]) {
  const __m512i a = _mm512_loadu_si512(from[0]);
  const __m512i b = _mm512_loadu_si512(from[1]);
  const __m512i c = _mm512_loadu_si512(from[2]);
  for (int out = 0; out < 3; ++out) {
    const __m512i index = _mm512_load_si512(table.index[out]);
    const __m512i low = _mm512_permutex2var_epi8(a, index, b);
    _mm512_storeu_si512(to[out], _mm512_mask_permutexvar_epi8(low, table.mask[out], index, c));
  }
}

inline std::size_t split_bytes_shuffled(const std::byte* bytes, std::size_t count, std::uint8_t* y,
                                        std::uint8_t* u, std::uint8_t* v) {
  std::size_t i = 0;
  for (; i + 64 <= count; i += 64) {
    const std::byte* from = bytes + 3 * i;
    permute3({from, from + 64, from + 128}, kSplit3, {y + i, u + i, v + i});
  }
  return i;
}

inline std::size_t join_bytes_shuffled(const std::uint8_t* y, const std::uint8_t* u,
                                       const std::uint8_t* v, std::size_t count, std::byte* bytes) {
  std::size_t i = 0;
  for (; i + 64 <= count; i += 64) {
    std::byte* to = bytes + 3 * i;
    permute3({y + i, u + i, v + i}, kJoin3, {to, to + 64, to + 128});
  }
  return i;
}

#elif defined(__SSSE3__)

/// Shuffle control that takes to place i the byte that is `phase + 3i` of three registers, if it
/// lies in register `part`; 0x80 (zero) otherwise.
struct Split3 {
  alignas(16) std::int8_t control[3][3][16];  // [plane][part][place]
};
constexpr Split3 make_split3() {
  Split3 table{};
  for (int plane = 0; plane < 3; ++plane) {
    for (int part = 0; part < 3; ++part) {
      for (int i = 0; i < 16; ++i) {
        const int from = 3 * i + plane - 16 * part;
        table.control[plane][part][i] =
            static_cast<std::int8_t>(from >= 0 && from < 16 ? from : -128);
      }
    }
  }
  return table;
}
/// The reverse: to place i of register `part` the sample (16·part + i) / 3 of plane `plane`.
constexpr Split3 make_join3() {
  Split3 table{};
  for (int plane = 0; plane < 3; ++plane) {
    for (int part = 0; part < 3; ++part) {
      for (int i = 0; i < 16; ++i) {
        const int at = 16 * part + i;
        table.control[plane][part][i] = static_cast<std::int8_t>(at % 3 == plane ? at / 3 : -128);
      }
    }
  }
  return table;
}
constexpr Split3 kSplit3 = make_split3();
constexpr Split3 kJoin3 = make_join3();

inline __m128i control(const std::int8_t (&bytes)[16]) {
  return _mm_load_si128(reinterpret_cast<const __m128i*>(bytes));
}
inline __m128i loadu(const void* from) {
  return _mm_loadu_si128(static_cast<const __m128i*>(from));
}
inline __m128i shuffle3(const __m128i (&in)[3], const std::int8_t (&c0)[16],
                        const std::int8_t (&c1)[16], const std::int8_t (&c2)[16]) {
  return _mm_or_si128(
      _mm_or_si128(_mm_shuffle_epi8(in[0], control(c0)), _mm_shuffle_epi8(in[1], control(c1))),
      _mm_shuffle_epi8(in[2], control(c2)));
}

inline std::size_t split_bytes_shuffled(const std::byte* bytes, std::size_t count, std::uint8_t* y,
                                        std::uint8_t* u, std::uint8_t* v) {
  std::uint8_t* const planes[3] = {y, u, v};
  std::size_t i = 0;
  for (; i + 16 <= count; i += 16) {
    const std::byte* from = bytes + 3 * i;
    const __m128i in[3] = {loadu(from), loadu(from + 16), loadu(from + 32)};
    for (int plane = 0; plane < 3; ++plane) {
      const auto& c = kSplit3.control[plane];
      _mm_storeu_si128(reinterpret_cast<__m128i*>(planes[plane] + i),
                       shuffle3(in, c[0], c[1], c[2]));
    }
  }
  return i;
}

inline std::size_t join_bytes_shuffled(const std::uint8_t* y, const std::uint8_t* u,
                                       const std::uint8_t* v, std::size_t count, std::byte* bytes) {
  std::size_t i = 0;
  for (; i + 16 <= count; i += 16) {
    const __m128i in[3] = {loadu(y + i), loadu(u + i), loadu(v + i)};
    for (int part = 0; part < 3; ++part) {
      const auto& c = kJoin3.control;
      _mm_storeu_si128(reinterpret_cast<__m128i*>(bytes + 3 * i + 16 * part),
                       shuffle3(in, c[0][part], c[1][part], c[2][part]));
    }
  }
  return i;
}

#else

inline std::size_t split_bytes_shuffled(const std::byte*, std::size_t, std::uint8_t*, std::uint8_t*,
                                        std::uint8_t*) {
  return 0;
}
inline std::size_t join_bytes_shuffled(const std::uint8_t*, const std::uint8_t*,
                                       const std::uint8_t*, std::size_t, std::byte*) {
  return 0;
}

#endif

}  // namespace
}  // namespace gicodec::GICODEC_ISA
