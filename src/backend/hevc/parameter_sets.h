// Checks of HEVC parameter sets and slice headers before a third-party decoder sees them: syntax
// completely parsed, sizes as expected, features limited to what a lossless encoder of one picture
// per update uses (docs: "HEVC payload", restrictions).
#pragma once

#include "backend/hevc/picture.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::hevc {

/// What slice headers depend on.
struct ParameterSets {
  unsigned slice_address_bits = 0;
  bool dependent_slices = false;
  unsigned extra_slice_header_bits = 0;
};

/// Each takes a NAL unit's bytes behind its two-byte header. False if anything is not as required.
[[nodiscard]] bool check_vps(std::span<const std::byte> payload) noexcept;
[[nodiscard]] bool check_sps(std::span<const std::byte> payload, const PictureFormat& expected,
                             ParameterSets& sets) noexcept;
[[nodiscard]] bool check_pps(std::span<const std::byte> payload, ParameterSets& sets) noexcept;
[[nodiscard]] bool check_slice(std::span<const std::byte> payload, bool idr, bool first,
                               const ParameterSets& sets) noexcept;

}  // namespace gicodec::hevc
