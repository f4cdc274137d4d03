// Checks HEVC parameter sets and slice headers before a third-party decoder sees them: parses all
// syntax, compares sizes, and refuses features that a lossless encoder of one picture per update
// does not use (FORMAT.md, "HEVC payload").
#pragma once

#include "backend/hevc/picture.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::hevc {

/// Short-term reference picture sets: the number of pictures in each.
struct ReferenceSets {
  std::uint32_t count = 0;
  std::array<std::uint32_t, 65>
      pictures{};  ///< a sequence has up to 64; one more for a slice's own
};

/// Fields of parameter sets that slice headers depend on.
struct ParameterSets {
  bool monochrome = false;
  unsigned offset_half_range = 128;  ///< of weighted prediction
  unsigned poc_bits = 0;
  ReferenceSets reference_sets;
  bool temporal_mvp = false;
  bool sample_adaptive_offset = false;
  unsigned slice_address_bits = 0;
  bool dependent_slices = false;
  unsigned extra_slice_header_bits = 0;
  bool cabac_init_present = false;
  std::uint32_t references[2] = {};  ///< default number of active pictures in each list
  bool weighted_prediction = false, weighted_biprediction = false;
};

/// `payload`: a NAL unit behind its two-byte header. False if it breaks a requirement.
[[nodiscard]] bool check_vps(std::span<const std::byte> payload) noexcept;
[[nodiscard]] bool check_sps(std::span<const std::byte> payload, const PictureFormat& expected,
                             ParameterSets& sets) noexcept;
[[nodiscard]] bool check_pps(std::span<const std::byte> payload, ParameterSets& sets) noexcept;
/// Checks a slice header up to the weights of inter prediction, which may be out of range.
[[nodiscard]] bool check_slice(std::span<const std::byte> payload, bool idr, bool first,
                               const ParameterSets& sets) noexcept;

class SyntaxReader;
/// st_ref_pic_set(index); in a slice header the index is sets.count.
void read_reference_set(SyntaxReader& in, std::uint32_t index, ReferenceSets& sets) noexcept;

}  // namespace gicodec::hevc
