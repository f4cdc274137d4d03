// How far decoded records may be from those that were encoded. One number says it for a texture:
//   0       nowhere: every bit is the same
//   >= 1    that many codes of unorm, snorm and uint components and of mantissas under a shared
//           exponent, that many representable values (ULP) of floats; a fraction is dropped
//   < 1     relatively, of floats (below the smallest normal number: of that); all others are exact
// Exponents and opaque components are exact whatever it is; so are NaN, infinities and zeros of
// floats, and their signs.
#pragma once

#include <gicodec/api.h>
#include <gicodec/record.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace GICODEC_API gicodec {

/// Whether a number means something: finite, not negative.
[[nodiscard]] bool valid_error(float max_error) noexcept;
/// Codes or ULP that a component may be off; 0: it is exact.
[[nodiscard]] std::uint32_t error_units(const Component& component, float max_error) noexcept;
/// True if some component of such records may be off.
[[nodiscard]] bool allows_error(const Record& record, float max_error) noexcept;
/// How far off records may be that were off by one and then by the other: counts add up, of
/// anything else nothing can be said (infinity).
[[nodiscard]] float both_errors(float first, float second) noexcept;
/// True if no component of `decoded` is off by more. Both hold whole records, the same number.
[[nodiscard]] bool within_error(const Record& record, std::span<const std::byte> given,
                                std::span<const std::byte> decoded, float max_error) noexcept;

}  // namespace gicodec
