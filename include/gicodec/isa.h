// Instruction sets that kernels are compiled for. All give the same bits; the best one that the
// machine has is used unless another one is asked for, to compare or to track down errors. A
// session keeps to its set in all of the library's own loops; third-party codecs choose for
// themselves.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace gicodec {

/// Ascending: each includes those before it.
enum class Isa : std::uint8_t {
  scalar = 0,
  sse4 = 1,    ///< SSE4.1
  avx2 = 2,    ///< AVX2, BMI2
  avx512 = 3,  ///< AVX-512 F, BW, CD, DQ, VL, VBMI
};

/// What this machine can run, ascending; the last is the best. Always begins with scalar.
[[nodiscard]] std::span<const Isa> supported_isas() noexcept;
[[nodiscard]] inline Isa best_isa() noexcept { return supported_isas().back(); }
[[nodiscard]] bool is_supported(Isa isa) noexcept;
/// "scalar", "sse4", "avx2" or "avx512".
[[nodiscard]] std::string_view to_string(Isa isa) noexcept;
/// The inverse, nullopt for other names. The machine may lack it.
[[nodiscard]] std::optional<Isa> isa_from_string(std::string_view name) noexcept;

}  // namespace gicodec
