#include <gicodec/isa.h>

#if defined(_MSC_VER)
#include <intrin.h>
#endif

#include <algorithm>
#include <array>
#include <cstdint>

namespace gicodec {
namespace {

constexpr std::array<std::string_view, 6> kNames{"scalar", "sse4", "avx2",
                                                 "avx512", "neon", "simd128"};

/// The sets that the library was built with (cmake/Kernels.cmake).
constexpr auto kBuilt = [] {
  using enum Isa;
  return std::array{GICODEC_ISAS};
}();
#ifndef __wasm__  // A module for engines with vectors needs no scalar kernels.
static_assert(kBuilt.front() == Isa::scalar);
#endif

/// True if the processor has all that cmake/Kernels.cmake lets compilers use for the set. AArch64
/// always has NEON, and a WebAssembly engine refuses a module with unknown instructions.
bool runs_here(Isa isa) noexcept {
#if defined(_MSC_VER) && defined(_M_X64)
  int first[4]{}, extended[4]{};
  __cpuid(first, 0);
  if (first[0] < 7) return isa == Isa::scalar;
  __cpuid(first, 1);
  __cpuidex(extended, 7, 0);
  const auto has = [](int word, int bit) { return (word >> bit & 1) != 0; };
  // What the system saves of the registers' state: 6 for AVX, 0xE0 more for AVX-512.
  const std::uint64_t saved = has(first[2], 27) ? _xgetbv(0) : 0;
  switch (isa) {
    case Isa::sse4:
      return has(first[2], 19);
    case Isa::avx2:
      return (saved & 6) == 6 && has(extended[1], 5) && has(extended[1], 8);
    case Isa::avx512:
      return (saved & 0xE6) == 0xE6 && has(extended[1], 16) && has(extended[1], 17) &&
             has(extended[1], 28) && has(extended[1], 30) && has(extended[1], 31) &&
             has(extended[2], 1) && has(extended[2], 6);
    default:
      return true;
  }
#elif defined(__x86_64__)
  switch (isa) {
    case Isa::sse4:
      return __builtin_cpu_supports("sse4.1");
    case Isa::avx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2");
    case Isa::avx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
             __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512vbmi") &&
             __builtin_cpu_supports("avx512vbmi2");
    default:
      return true;
  }
#else
  static_cast<void>(isa);
  return true;
#endif
}

std::size_t count_supported() noexcept {
#if defined(__x86_64__) && !defined(_MSC_VER)
  __builtin_cpu_init();
#endif
  return static_cast<std::size_t>(std::find_if_not(kBuilt.begin(), kBuilt.end(), runs_here) -
                                  kBuilt.begin());
}

}  // namespace

std::span<const Isa> supported_isas() noexcept {
  static const std::size_t count = count_supported();
  return std::span(kBuilt).first(count);
}

bool is_supported(Isa isa) noexcept {
  const auto isas = supported_isas();
  return std::find(isas.begin(), isas.end(), isa) != isas.end();
}

std::string_view to_string(Isa isa) noexcept { return kNames[static_cast<std::size_t>(isa)]; }

std::optional<Isa> isa_from_string(std::string_view name) noexcept {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<Isa>(found - kNames.begin());
}

}  // namespace gicodec
