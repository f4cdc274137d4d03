#include "backend/hevc/parameter_sets.h"
#include "backend/hevc/syntax_reader.h"

#include <bit>

namespace gicodec::hevc {
namespace {

enum SliceType : std::uint32_t { kSliceB = 0, kSliceP = 1, kSliceI = 2 };

constexpr std::uint32_t kMaxActiveReferences = 15;

void read_weight(SyntaxReader& in) noexcept { in.require(in.se(128) < 128); }

// An offset from −limit to limit − 1.
void read_offset(SyntaxReader& in, unsigned limit) noexcept {
  const auto bound = static_cast<std::int32_t>(limit);
  in.require(in.se(bound) < bound);
}

// pred_weight_table()
void read_weights(SyntaxReader& in, unsigned lists, const std::uint32_t references[2],
                  const ParameterSets& sets) noexcept {
  const auto luma_denominator = static_cast<std::int32_t>(in.ue(7));
  if (!sets.monochrome) {
    const std::int32_t denominator = luma_denominator + in.se(7);
    in.require(denominator >= 0 && denominator <= 7);
  }
  for (unsigned list = 0; list < lists; ++list) {
    std::uint32_t luma = 0, chroma = 0;
    for (std::uint32_t i = 0; i < references[list]; ++i) luma |= std::uint32_t{in.flag()} << i;
    if (!sets.monochrome) {
      for (std::uint32_t i = 0; i < references[list]; ++i) chroma |= std::uint32_t{in.flag()} << i;
    }
    for (std::uint32_t i = 0; i < references[list]; ++i) {
      if ((luma >> i & 1U) != 0) {
        read_weight(in);
        read_offset(in, sets.offset_half_range);
      }
      for (unsigned plane = 0; (chroma >> i & 1U) != 0 && plane < 2; ++plane) {
        read_weight(in);
        read_offset(in, 4 * sets.offset_half_range);
      }
    }
  }
}

// From num_ref_idx_active_override_flag to five_minus_max_num_merge_cand.
void read_inter(SyntaxReader& in, bool bidirectional, bool temporal_mvp,
                const ParameterSets& sets) noexcept {
  const unsigned lists = bidirectional ? 2 : 1;
  std::uint32_t references[2] = {sets.references[0], sets.references[1]};
  if (in.flag()) {
    for (unsigned list = 0; list < lists; ++list) {
      references[list] = in.ue(kMaxActiveReferences - 1) + 1;
    }
  }
  if (bidirectional) in.flag();            // mvd_l1_zero_flag
  if (sets.cabac_init_present) in.flag();  // cabac_init_flag
  if (temporal_mvp) {
    const bool second_list = bidirectional && !in.flag();  // collocated_from_l0_flag
    const std::uint32_t choices = references[second_list ? 1 : 0];
    if (choices > 1) in.ue(choices - 1);  // collocated_ref_idx
  }
  if (bidirectional ? sets.weighted_biprediction : sets.weighted_prediction) {
    read_weights(in, lists, references, sets);
  }
  in.ue(4);  // five_minus_max_num_merge_cand
}

}  // namespace

bool check_slice(std::span<const std::byte> payload, bool idr, bool first,
                 const ParameterSets& sets) noexcept {
  SyntaxReader in(payload);
  in.require(in.flag() == first);  // first_slice_segment_in_pic_flag
  if (idr) in.flag();              // no_output_of_prior_pics_flag
  in.ue(0);                        // picture parameter set id
  if (!first) {
    const bool dependent = sets.dependent_slices && in.flag();
    in.require(in.bits(sets.slice_address_bits) != 0);
    if (dependent) return in.ok();
  }
  in.skip(sets.extra_slice_header_bits);
  const std::uint32_t type = in.ue(kSliceI);
  in.require(!idr || type == kSliceI);
  bool temporal_mvp = false;
  if (!idr) {
    in.skip(sets.poc_bits);
    const std::uint32_t count = sets.reference_sets.count;
    if (!in.flag()) {  // short_term_ref_pic_set_sps_flag
      ReferenceSets own = sets.reference_sets;
      read_reference_set(in, count, own);
    } else {
      in.require(count > 0);
      if (count > 1) in.require(in.bits(std::bit_width(count - 1)) < count);
    }
    temporal_mvp = sets.temporal_mvp && in.flag();
  }
  if (sets.sample_adaptive_offset) in.skip(sets.monochrome ? 1 : 2);
  if (type != kSliceI) read_inter(in, type == kSliceB, temporal_mvp, sets);
  in.se(128);  // slice_qp_delta
  return in.ok();
}

}  // namespace gicodec::hevc
