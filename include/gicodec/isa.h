// Instruction sets that kernels are compiled for. All give the same bits; the best one that the
// machine has is used unless another one is asked for, to compare or to track down errors. A
// session keeps to its set in all of the library's own loops; third-party codecs choose for
// themselves.
#pragma once

#include <gicodec/api.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace GICODEC_API gicodec {

/// Those of an architecture are in ascending order: each includes those before it.
enum class Isa : std::uint8_t {
  scalar = 0,   ///< what every machine of the architecture has
  sse4 = 1,     ///< x86-64: SSE4.1
  avx2 = 2,     ///< x86-64: AVX2, BMI2
  avx512 = 3,   ///< x86-64: AVX-512 F, BW, CD, DQ, VL, VBMI
  neon = 4,     ///< AArch64: its Advanced SIMD, which every such machine has
  simd128 = 5,  ///< WebAssembly: 128-bit vectors
};

/// What this machine can run, ascending; the last is the best. Always begins with scalar.
[[nodiscard]] std::span<const Isa> supported_isas() noexcept;
[[nodiscard]] inline Isa best_isa() noexcept { return supported_isas().back(); }
[[nodiscard]] bool is_supported(Isa isa) noexcept;
/// The name above: "scalar", "sse4", ...
[[nodiscard]] std::string_view to_string(Isa isa) noexcept;
/// The inverse, nullopt for other names. The machine may lack it.
[[nodiscard]] std::optional<Isa> isa_from_string(std::string_view name) noexcept;

}  // namespace gicodec
