// Error bounds: how far decoded records may be from the encoded ones. One number per texture:
//   0       lossless: every bit is the same
//   >= 1    absolute: that many codes of unorm, snorm and uint components and of mantissas under a
//           shared exponent, that many representable values (ULP) of floats; fractions are dropped
//   < 1     relative: that share of a float's value, or of the smallest normal number if the value
//           is smaller; all other components are exact
// Exponents and opaque components are always exact, as are NaN, infinities, zeros and signs of
// floats.
#pragma once

#include <gicodec/api.h>
#include <gicodec/record.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace GICODEC_API gicodec {

/// True if the number is finite and not negative.
[[nodiscard]] bool valid_error(float max_error) noexcept;
/// Codes or ULP that a component may differ by; 0: it is exact.
[[nodiscard]] std::uint32_t error_units(const Component& component, float max_error) noexcept;
/// True if some component of the record may differ.
[[nodiscard]] bool allows_error(const Record& record, float max_error) noexcept;
/// The bound of records coded twice, under one bound and then the other. Two absolute bounds add
/// up; any other two that are not 0 give infinity (unknown).
[[nodiscard]] float both_errors(float first, float second) noexcept;
/// True if every component of `decoded` keeps the bound. Both hold the same number of records.
[[nodiscard]] bool within_error(const Record& record, std::span<const std::byte> given,
                                std::span<const std::byte> decoded, float max_error) noexcept;

}  // namespace gicodec
