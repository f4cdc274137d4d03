// The NAL units of an access unit in Annex B byte stream format.
#pragma once

#include "backend/hevc/parameter_sets.h"
#include "backend/hevc/picture.h"

#include <gicodec/status.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace gicodec::hevc {

/// Comes before each NAL unit.
inline constexpr std::array kStartCode{std::byte{0}, std::byte{0}, std::byte{0}, std::byte{1}};
using NalUnit = std::span<const std::byte>;  ///< two header bytes and payload, no start code

struct AccessUnit {
  bool idr = false;
  std::vector<NalUnit> units;  ///< IDR: video, sequence, picture parameter set; then slices
};

/// Splits and checks an access unit, which must hold only what a decoder needs. `sets` are those of
/// the last IDR access unit; an IDR access unit replaces them. `bytes` must outlive the result.
/// Errors: truncated (no NAL unit), corrupt, unsupported_feature (a NAL unit of a forbidden type).
[[nodiscard]] Result<AccessUnit> parse_access_unit(std::span<const std::byte> bytes,
                                                   const PictureFormat& expected,
                                                   ParameterSets& sets);

/// Appends the NAL units of an encoder's output that a decoder needs: no delimiters, no
/// supplemental information.
void append_access_unit(std::span<const std::byte> encoded, std::vector<std::byte>& out);

}  // namespace gicodec::hevc
