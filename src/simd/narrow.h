// Two registers of 32-bit words → one of 16-bit words. Part of kernels.inl: compiled per
// instruction set, internal linkage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__SSE4_1__)
#include <immintrin.h>
#endif

namespace gicodec::GICODEC_ISA {
namespace {

#if defined(__AVX512BW__)
inline constexpr std::size_t kWords = 16;
#elif defined(__AVX2__)
inline constexpr std::size_t kWords = 8;
#else
inline constexpr std::size_t kWords = 4;
#endif

using Words [[gnu::vector_size(4 * kWords)]] = std::uint32_t;

/// Stores the words of `a`, then those of `b`, all below 2^16.
inline void store_narrow(const Words& a, const Words& b, std::uint16_t* to) {
#if defined(__AVX512BW__)
  alignas(64) static constexpr std::uint16_t kEven[32] = {
      0,  2,  4,  6,  8,  10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30,
      32, 34, 36, 38, 40, 42, 44, 46, 48, 50, 52, 54, 56, 58, 60, 62};
  const __m512i even = _mm512_load_si512(kEven);
  _mm512_storeu_si512(to, _mm512_permutex2var_epi16(reinterpret_cast<const __m512i&>(a), even,
                                                    reinterpret_cast<const __m512i&>(b)));
#elif defined(__AVX2__)
  // Packing works within halves: put the quarters back in order.
  const __m256i packed =
      _mm256_packus_epi32(reinterpret_cast<const __m256i&>(a), reinterpret_cast<const __m256i&>(b));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm256_permute4x64_epi64(packed, 0xD8));
#elif defined(__SSE4_1__)
  _mm_storeu_si128(
      reinterpret_cast<__m128i*>(to),
      _mm_packus_epi32(reinterpret_cast<const __m128i&>(a), reinterpret_cast<const __m128i&>(b)));
#else
  for (std::size_t i = 0; i < kWords; ++i) {
    to[i] = static_cast<std::uint16_t>(a[i]);
    to[kWords + i] = static_cast<std::uint16_t>(b[i]);
  }
#endif
}

}  // namespace
}  // namespace gicodec::GICODEC_ISA
