// Which of its eight slots each basis of a texel has, for the codec's sake.
#pragma once

#include "clusters.h"

namespace gicodec::maps {

/// Gives bases the slots that the texel to the left, or else above, has them in; slots that are not
/// used name the basis that the texel to the left names there. `texels` by ascending place, on a
/// map of that width.
void align_slots(std::span<const MapTexel> texels, std::uint32_t width, std::span<Blend> blends);

}  // namespace gicodec::maps
