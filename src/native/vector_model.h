// Irradiance vectors at the vertices of a grid (docs/native.md, "Vectors"): each hemisphere by
// those of vertices around, weighted by how alike their other hemispheres are; the second of two
// opposite ones also by what all pairs sum up to.
#pragma once

#include "native/value_model.h"
#include "native/vector_guesses.h"

namespace gicodec::native {

/// Memory of one thread.
class VectorModel {
 public:
  /// Before the first vertex of a chunk; `values` must outlive its last.
  void reset(const Record& record, ValueModel& values);
  /// One vertex, from `in` or into `out`. `past`: its mirror block, empty in keyframes and where
  /// it has no light.
  template <typename Coder>
  void code(Coder& coder, const KnownVertices& around, std::span<const std::byte> past,
            std::span<const std::byte> in, std::span<std::byte> out);

 private:
  struct Hemisphere;

  template <typename Coder>
  bool code_lit(Coder& coder, const KnownVertices& around, bool known, bool lit);
  template <typename Coder>
  void code_hemisphere(Coder& coder, unsigned h, VectorCodes& now);
  template <typename Coder>
  void code_direction(Coder& coder, Hemisphere& here, VectorCodes& now);
  template <typename Coder>
  void code_colors(Coder& coder, Hemisphere& here, VectorCodes& now);
  void learn(unsigned h, const HemisphereLight& light);

  ValueModel* values_ = nullptr;
  VectorForm form_{Record{}};
  VectorGuesses::Vertex last_{};  ///< the last vertex with light in the chunk
  bool any_ = false;
  std::uint32_t same_before_ = 0;  ///< hemispheres of the last vertex that were as before, by bit

  // Of the vertex.
  VectorGuesses guesses_;
  std::array<HemisphereLight, kHemispheres> light_{};            ///< as it was coded
  std::array<std::array<std::int64_t, 2>, kHemispheres> off_{};  ///< residuals of directions
  std::array<std::int64_t, kHemispheres> off_exponent_{}, off_green_{};
};

}  // namespace gicodec::native
