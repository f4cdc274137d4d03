// Instruction sets that kernels are compiled for. All give the same bits. The default is the best
// that the machine has; others serve to compare and to find errors. A session uses one set in all
// loops of the library; third-party codecs choose for themselves.
#pragma once

#include <gicodec/api.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace GICODEC_API gicodec {

/// Ascending within an architecture: each set includes those before it.
enum class Isa : std::uint8_t {
  scalar = 0,   ///< every machine of the architecture
  sse4 = 1,     ///< x86-64: SSE4.1
  avx2 = 2,     ///< x86-64: AVX2, BMI2
  avx512 = 3,   ///< x86-64: AVX-512 F, BW, CD, DQ, VL, VBMI
  neon = 4,     ///< AArch64: Advanced SIMD, on every machine
  simd128 = 5,  ///< WebAssembly: 128-bit vectors
};

/// The sets that this machine can run, ascending: scalar first, the best last. Static storage.
[[nodiscard]] std::span<const Isa> supported_isas() noexcept;
[[nodiscard]] inline Isa best_isa() noexcept { return supported_isas().back(); }
[[nodiscard]] bool is_supported(Isa isa) noexcept;
/// The enumerator's name, e.g. "sse4".
[[nodiscard]] std::string_view to_string(Isa isa) noexcept;
/// The inverse; nullopt for any other name. The machine may lack the set.
[[nodiscard]] std::optional<Isa> isa_from_string(std::string_view name) noexcept;

}  // namespace gicodec
