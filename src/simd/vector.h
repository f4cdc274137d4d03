// Shared by the vector wrappers. Each wrapper (vector_*.inl) has the same operations for its
// instruction set: on 32 lanes of 16 (I16) or 32 bits (U32), and on masks of lanes (M16). Kernels
// include intrinsics.h and, within an unnamed namespace, the wrapper of their set, GICODEC_VECTORS.
#pragma once

#include <bit>
#include <cstdint>

#ifdef GICODEC_SMALL  // Small rather than fast.
#define GICODEC_INLINE inline
#define GICODEC_INLINE_LAMBDA
#define GICODEC_INLINE_STEP [[gnu::noinline]]
#define GICODEC_NO_UNROLL
#else
/// Vector values stay in registers only if every function that handles them is inlined.
#define GICODEC_INLINE [[gnu::always_inline]] inline
#define GICODEC_INLINE_LAMBDA __attribute__((always_inline))
#define GICODEC_INLINE_STEP GICODEC_INLINE
#endif
// GICODEC_STEP, which each wrapper defines, is for what a kernel does several times in a texel:
// inlined too, or out of line where the kernel would outgrow the cache of instructions.
/// Unrolls loops over arrays of vectors, which would otherwise live in memory. Off where lanes are
/// array elements or nothing stays in registers anyway: compilers would only take minutes longer.
#if defined(__has_feature)  // clang's test for sanitizers
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define GICODEC_NO_UNROLL
#endif
#endif
#if defined(__wasm__) && !defined(__wasm_simd128__)
#define GICODEC_NO_UNROLL
#endif
#if defined(GICODEC_NO_UNROLL) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define GICODEC_UNROLL
#elif defined(__clang__)
#define GICODEC_UNROLL _Pragma("unroll")
#else
#define GICODEC_UNROLL _Pragma("GCC unroll 8")
#endif

namespace gicodec {

inline constexpr unsigned kLanes = 32;
/// Entropy coders' 32-bit states stay at kStateLow or above: refill() and spill() move words.
inline constexpr std::uint32_t kStateLow = 1U << 16;

/// A table of 16 bytes, the first of which is 0.
struct NibbleTable {
  std::uint8_t entry[16];
};

}  // namespace gicodec
