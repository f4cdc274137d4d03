// Descriptions of textures for property tests: records, blocks, layouts, presence.
#pragma once

#include "support.h"

namespace gicodec::test {

/// A record of the application's own: 1..64 bytes in 1..16 components in any order.
Record custom_record(Random& random, std::uint8_t bytes);
/// A preset, or one of the application's own.
Record any_record(Random& random);
/// Another layout for the same texture: tilings, padding, slots.
Layout any_layout(Random& random, const TextureDesc& desc);
/// Probes: square blocks of depth 1 with or without guard band on a small odd grid, sides of 1 to
/// 64 with small ones more often, at most about `max_records` records; every preset and layout.
TextureDesc probe_desc(Random& random, std::uint32_t max_records = 20000);
/// Whatever a description can say: also blocks of any shape, pools, presence, grids that end within
/// blocks, records of one's own, other predictions.
TextureDesc any_desc(Random& random, std::uint32_t max_records = 20000);
/// Blocks of 8×8×2 floats on a grid of 3×2×5, without guard band.
TextureDesc bricks();
/// Which records exist, for every block.
Bytes any_presence(Random& random, const TextureDesc& desc);
Bytes full_presence(const TextureDesc& desc);

}  // namespace gicodec::test
