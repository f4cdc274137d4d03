// Light over six hemispheres, at vertices and voxels (docs/native/light.md): each
// by those around, weighted by how similar their other hemispheres are; of vertices, the second of
// two opposite ones also by what all pairs sum up to.
#pragma once

#include "native/mixed/value_model.h"
#include "native/models/light/light_predictors.h"

namespace gicodec::native {

/// Memory of one thread.
class LightModel {
 public:
  /// Before the first light of a chunk; `values` must outlive its last.
  void reset(const Record& record, ValueModel& values);
  /// One vertex, from `in` or into `out`. `previous`: what the mirror has of it, empty in keyframes
  /// and where it has no light.
  template <typename Coder>
  void code(Coder& coder, const KnownLights& around, std::span<const std::byte> previous,
            std::span<const std::byte> in, std::span<std::byte> out);
  /// The occupancy of a voxel, which comes before the light of its siblings: of `in`, or as read.
  template <typename Coder>
  LightOccupancy code_occupancy(Coder& coder, const KnownLights& around,
                                std::span<const std::byte> previous, std::span<const std::byte> in);
  /// The light of a voxel whose occupancy is not empty.
  template <typename Coder>
  void code(Coder& coder, LightOccupancy occupancy, const KnownLights& around,
            std::span<const std::byte> previous, std::span<const std::byte> in,
            std::span<std::byte> out);

 private:
  struct Hemisphere;

  template <typename Coder>
  bool code_lit(Coder& coder, const KnownLights& around, std::span<const std::byte> in);
  template <typename Coder>
  void code_alpha(Coder& coder, unsigned h, LightCodes& now);
  [[nodiscard]] std::array<FlagContext, kFlagContexts> same_contexts(const KnownLights& around,
                                                                     unsigned h,
                                                                     std::uint32_t same) const;
  template <typename Coder>
  void code_hemisphere(Coder& coder, unsigned h, LightCodes& now);
  template <typename Coder>
  void code_direction(Coder& coder, Hemisphere& here, LightCodes& now);
  template <typename Coder>
  void code_colors(Coder& coder, Hemisphere& here, LightCodes& now);
  void learn(unsigned h, const HemisphereLight& light);

  ValueModel* values_ = nullptr;
  LightEncoding encoding_{Record{}};
  LightPredictors::Codes last_{};  ///< the last one with light in the chunk
  bool any_ = false;
  std::uint32_t same_before_ = 0;  ///< hemispheres of the last one that were as before, by bit

  // Of the one that is coded.
  LightPredictors predictors_;
  LightPredictors::Codes previous_{};  ///< if it has one
  bool known_ = false;
  std::array<HemisphereLight, kHemispheres> light_{};  ///< as it was coded
  std::array<std::array<std::int64_t, 2>, kHemispheres>
      direction_residual_{};  ///< residuals of directions
  std::array<std::int64_t, kHemispheres> exponent_residual_{}, green_residual_{};
};

}  // namespace gicodec::native
