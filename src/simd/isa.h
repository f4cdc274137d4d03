// Instruction sets: which there are, which this machine has.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace gicodec {

/// Ascending: each includes those before it.
enum class Isa : std::uint8_t {
  scalar = 0,
  sse4 = 1,    ///< SSE4.1
  avx2 = 2,    ///< AVX2, BMI2
  avx512 = 3,  ///< AVX-512 F, BW, DQ, VL, VBMI
};

/// What this machine can run, ascending; the last is the best. Always begins with scalar.
[[nodiscard]] std::span<const Isa> supported_isas() noexcept;
[[nodiscard]] inline Isa best_isa() noexcept { return supported_isas().back(); }
/// "scalar", "sse4", "avx2" or "avx512".
[[nodiscard]] std::string_view to_string(Isa isa) noexcept;

}  // namespace gicodec
