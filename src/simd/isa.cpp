#include <gicodec/isa.h>

#include <algorithm>
#include <array>

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
#if defined(__x86_64__)
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
#if defined(__x86_64__)
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
