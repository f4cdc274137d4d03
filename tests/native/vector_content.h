// Updates of light at vertices for the native codec's tests.
#pragma once

#include "native/content.h"

namespace gicodec::test {

/// Evenly in [low, high).
[[nodiscard]] double number(Random& random, double low, double high);

/// Light of a few lamps with walls in between, which are zero; sums of light from the same
/// directions for all hemispheres, as native expects them; values at the edges of what there is;
/// any bytes.
enum class VertexContent { smooth, integrated, edges, bits };
inline constexpr VertexContent kVertexContents[] = {
    VertexContent::smooth, VertexContent::integrated, VertexContent::edges, VertexContent::bits};

enum class UpdateMode { keyframe, update, intra };
inline constexpr UpdateMode kUpdateModes[] = {UpdateMode::keyframe, UpdateMode::update,
                                              UpdateMode::intra};

[[nodiscard]] TextureDesc vertices(Grid grid, bool floats);
/// Records of every vertex at frame 0, 1, ...
[[nodiscard]] Bytes make_vertices(const TextureDesc& desc, VertexContent content, unsigned frame,
                                  std::uint64_t seed);
/// As make_update(); some hemispheres of some vertices are as in the mirror.
[[nodiscard]] UpdateCase make_vertex_update(const TextureDesc& desc, VertexContent content,
                                            UpdateMode mode, std::uint32_t one_in,
                                            std::uint64_t seed);

}  // namespace gicodec::test
