#include "backend/hevc/parameter_sets.h"

#include "backend/hevc/syntax_reader.h"

#include <bit>

namespace gicodec::hevc {
namespace {

constexpr std::size_t kMaxParameterSetBytes = 1024;
constexpr std::uint32_t kMaxReferencePictures = 16;
constexpr std::uint32_t kMaxCroppedSamples = 64;  // an encoder rounds up to its coding tree unit

// profile_tier_level() with one sub-layer.
void profile_tier_level(SyntaxReader& in) { in.skip(2 + 1 + 5 + 32 + 4 + 43 + 1 + 8); }

// Ordering information of one sub-layer, without reordering.
void ordering_info(SyntaxReader& in) {
  in.ue(kMaxReferencePictures - 1);  // max_dec_pic_buffering_minus1
  in.ue(0);                          // max_num_reorder_pics
  in.ue();                           // max_latency_increase_plus1
}

void video_usability(SyntaxReader& in) {
  if (in.flag()) {                       // aspect_ratio_info_present_flag
    if (in.bits(8) == 255) in.skip(32);  // extended SAR
  }
  if (in.flag()) in.flag();  // overscan
  if (in.flag()) {           // video_signal_type_present_flag
    in.skip(3 + 1);
    if (in.flag()) {
      in.skip(16);
      in.require(in.bits(8) != 0);  // matrix 0 would reorder the planes as G, B, R
    }
  }
  if (in.flag()) {  // chroma_loc_info_present_flag
    in.ue(5);
    in.ue(5);
  }
  in.flag();               // neutral_chroma_indication_flag
  in.require(!in.flag());  // field_seq_flag
  in.flag();               // frame_field_info_present_flag
  in.require(!in.flag());  // default_display_window_flag
  if (in.flag()) {         // vui_timing_info_present_flag
    in.skip(64);
    if (in.flag()) in.ue();
    in.require(!in.flag());  // vui_hrd_parameters_present_flag
  }
  if (in.flag()) {  // bitstream_restriction_flag
    in.skip(3);
    in.ue(4095);
    in.ue(16);
    in.ue(16);
    in.ue(15);
    in.ue(15);
  }
}

// The nine flags of sps_range_extension(). Refuses those that need more than 16-bit arithmetic.
void sps_range_extension(SyntaxReader& in, unsigned bit_depth, ParameterSets& sets) {
  in.skip(4);
  in.require(!in.flag());  // extended_precision_processing_flag
  in.flag();
  if (in.flag()) sets.offset_half_range = 1U << (bit_depth - 1);  // high_precision_offsets
  in.flag();
  in.require(!in.flag());  // cabac_bypass_alignment_enabled_flag
}

}  // namespace

void read_reference_set(SyntaxReader& in, std::uint32_t index, ReferenceSets& sets) noexcept {
  std::uint32_t pictures = 0;
  if (index > 0 && in.flag()) {  // inter_ref_pic_set_prediction_flag
    const std::uint32_t distance = index == sets.count ? in.ue(index - 1) + 1 : 1;
    in.flag();
    in.ue(0x7FFF);
    const std::uint32_t flags = in.ok() ? sets.pictures[index - distance] + 1 : 0;
    for (std::uint32_t j = 0; j < flags; ++j) {
      const bool used = in.flag();
      if (used || in.flag()) ++pictures;
    }
    in.require(pictures <= kMaxReferencePictures);
  } else {
    const std::uint32_t negative = in.ue(kMaxReferencePictures);
    const std::uint32_t positive = in.ue(kMaxReferencePictures - negative);
    pictures = negative + positive;
    for (std::uint32_t i = 0; in.ok() && i < pictures; ++i) {
      in.ue(0x7FFF);
      in.flag();
    }
  }
  sets.pictures[index] = in.ok() ? pictures : 0;
}

bool check_vps(std::span<const std::byte> payload) noexcept {
  SyntaxReader in(payload);
  in.require(payload.size() <= kMaxParameterSetBytes);
  in.require(in.bits(4) == 0);  // id
  in.require(in.bits(2) == 3);  // base layer internal, available
  in.require(in.bits(6) == 0);  // max_layers_minus1
  in.require(in.bits(3) == 0);  // max_sub_layers_minus1
  in.flag();                    // temporal_id_nesting
  in.require(in.bits(16) == 0xFFFF);
  profile_tier_level(in);
  in.flag();  // sub_layer_ordering_info_present_flag
  ordering_info(in);
  in.require(in.bits(6) == 0);  // max_layer_id
  in.ue(0);                     // num_layer_sets_minus1
  if (in.flag()) {              // vps_timing_info_present_flag
    in.skip(64);
    if (in.flag()) in.ue();
    in.ue(0);  // vps_num_hrd_parameters
  }
  in.require(!in.flag());  // vps_extension_flag
  in.trailing_bits();
  return in.ok();
}

bool check_sps(std::span<const std::byte> payload, const PictureFormat& expected,
               ParameterSets& sets) noexcept {
  SyntaxReader in(payload);
  sets = {};
  sets.monochrome = expected.monochrome;
  in.require(payload.size() <= kMaxParameterSetBytes);
  in.require(in.bits(4) == 0);  // video parameter set id
  in.require(in.bits(3) == 0);  // max_sub_layers_minus1
  in.flag();                    // temporal_id_nesting
  profile_tier_level(in);
  in.ue(0);  // id
  const std::uint32_t chroma = in.ue(3);
  in.require(chroma == (expected.monochrome ? 0U : 3U));
  if (chroma == 3) in.require(!in.flag());  // separate_colour_plane_flag
  const std::uint32_t width = in.ue(expected.width + kMaxCroppedSamples);
  const std::uint32_t height = in.ue(expected.height + kMaxCroppedSamples);
  std::uint32_t right = 0, bottom = 0;
  if (in.flag()) {  // conformance window, in samples for 4:4:4 and 4:0:0
    in.ue(0);
    right = in.ue(kMaxCroppedSamples);
    in.ue(0);
    bottom = in.ue(kMaxCroppedSamples);
  }
  in.require(width == expected.width + right && height == expected.height + bottom);
  in.require(in.ue(8) + 8 == expected.bit_depth);
  in.require(in.ue(8) + 8 == expected.bit_depth);
  sets.poc_bits = in.ue(12) + 4;
  in.flag();  // sub_layer_ordering_info_present_flag
  ordering_info(in);
  const std::uint32_t min_block = in.ue(3) + 3;           // log2 of the smallest coding block
  const std::uint32_t tree_block = min_block + in.ue(3);  // log2 of the coding tree block
  const std::uint32_t min_transform = in.ue(3) + 2;
  const std::uint32_t max_transform = min_transform + in.ue(3);
  in.require(tree_block >= 4 && tree_block <= 6 && min_transform < min_block);
  in.require(max_transform <= 5 && max_transform <= tree_block);
  if (!in.ok()) return false;
  const std::uint32_t block_mask = (1U << min_block) - 1;
  in.require((width & block_mask) == 0 && (height & block_mask) == 0);
  in.ue(tree_block - min_transform);  // max_transform_hierarchy_depth_inter
  in.ue(tree_block - min_transform);  // max_transform_hierarchy_depth_intra
  in.require(!in.flag());             // scaling_list_enabled_flag
  in.flag();                          // amp_enabled_flag
  sets.sample_adaptive_offset = in.flag();
  in.require(!in.flag());  // pcm_enabled_flag
  sets.reference_sets.count = in.ue(64);
  for (std::uint32_t i = 0; in.ok() && i < sets.reference_sets.count; ++i) {
    read_reference_set(in, i, sets.reference_sets);
  }
  in.require(!in.flag());  // long_term_ref_pics_present_flag
  sets.temporal_mvp = in.flag();
  in.flag();  // strong_intra_smoothing_enabled_flag
  if (in.flag()) video_usability(in);
  if (in.flag()) {  // sps_extension_present_flag
    const bool range = in.flag();
    in.require(in.bits(7) == 0);
    if (range) sps_range_extension(in, expected.bit_depth, sets);
  }
  in.trailing_bits();
  const std::uint32_t tree_mask = (1U << tree_block) - 1;
  const std::uint32_t trees =
      ((width + tree_mask) >> tree_block) * ((height + tree_mask) >> tree_block);
  sets.slice_address_bits = static_cast<unsigned>(std::bit_width(trees - 1));
  return in.ok();
}

bool check_pps(std::span<const std::byte> payload, ParameterSets& sets) noexcept {
  SyntaxReader in(payload);
  in.require(payload.size() <= kMaxParameterSetBytes);
  in.ue(0);  // id
  in.ue(0);  // sequence parameter set id
  sets.dependent_slices = in.flag();
  in.require(!in.flag());  // output_flag_present_flag
  sets.extra_slice_header_bits = in.bits(3);
  in.flag();  // sign_data_hiding_enabled_flag
  sets.cabac_init_present = in.flag();
  for (auto& references : sets.references) references = in.ue(14) + 1;
  in.se(76);  // init_qp_minus26
  in.flag();  // constrained_intra_pred_flag
  const bool transform_skip = in.flag();
  if (in.flag()) in.ue(3);  // cu_qp_delta_enabled_flag, diff_cu_qp_delta_depth
  in.se(12);                // pps_cb_qp_offset
  in.se(12);                // pps_cr_qp_offset
  in.flag();                // pps_slice_chroma_qp_offsets_present_flag
  sets.weighted_prediction = in.flag();
  sets.weighted_biprediction = in.flag();
  in.flag();               // transquant_bypass_enabled_flag
  in.require(!in.flag());  // tiles_enabled_flag
  in.flag();               // entropy_coding_sync_enabled_flag
  in.flag();               // pps_loop_filter_across_slices_enabled_flag
  if (in.flag()) {         // deblocking_filter_control_present_flag
    in.flag();
    if (!in.flag()) {  // pps_deblocking_filter_disabled_flag
      in.se(6);
      in.se(6);
    }
  }
  in.require(!in.flag());  // pps_scaling_list_data_present_flag
  in.require(!in.flag());  // lists_modification_present_flag
  in.ue(4);                // log2_parallel_merge_level_minus2
  in.require(!in.flag());  // slice_segment_header_extension_present_flag
  if (in.flag()) {         // pps_extension_present_flag
    const bool range = in.flag();
    in.require(in.bits(7) == 0);
    if (range) {
      if (transform_skip) in.ue(3);  // log2_max_transform_skip_block_size_minus2
      in.flag();                     // cross_component_prediction_enabled_flag
      in.require(!in.flag());        // chroma_qp_offset_list_enabled_flag
      in.ue(0);                      // log2_sao_offset_scale_luma
      in.ue(0);                      // log2_sao_offset_scale_chroma
    }
  }
  in.trailing_bits();
  return in.ok();
}

}  // namespace gicodec::hevc
