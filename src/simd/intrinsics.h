// Headers of intrinsics for the vector wrappers (vector.h).
#pragma once

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

#include <cstddef>
#include <cstdint>
#include <cstring>

// Functions of kernels have internal linkage (dispatch.h), those of <bit> have not.
[[gnu::always_inline]] static inline int lowest_bit(unsigned mask) { return __builtin_ctz(mask); }
[[gnu::always_inline]] static inline int bits_set(unsigned mask) {
  return __builtin_popcount(mask);
}
