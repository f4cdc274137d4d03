// Bricks of voxels (docs/native/octree.md).
#include "native/models/chunk_coding.h"
#include "quantise/set_order.h"

#include <algorithm>
#include <array>

namespace gicodec::native {

/// Brick by brick, in groups of eight siblings: the occupancy of each, then the light of those that
/// have any.
template <typename Coder>
bool code_octree(const ChunkCoding<Coder>& chunk) {
  constexpr unsigned kSiblings = KnownLights::kChildren;
  struct Voxel {
    std::span<const std::byte> previous;
    KnownLights around;
    LightOccupancy occupancy;
  };
  std::array<Voxel, kSiblings> siblings;
  const Record& record = chunk.update.desc.record;
  Bricks& bricks = chunk.memory.bricks;
  LightModel& model = chunk.memory.light;
  model.reset(record, chunk.memory.values);
  bricks.reset(chunk.update, chunk.positions);
  // Those of a voxel, out of a block's; of nothing nothing.
  const auto records_of = [&](auto block, unsigned m) {
    const std::size_t size = kVoxelDirections * std::size_t{record.bytes};
    return block.empty() ? block : block.subspan(bricks.offset(m), size);
  };
  for (std::size_t i = 0; i < chunk.positions.size(); ++i) {
    const std::uint32_t position = bricks.enter(chunk.update, chunk.records, i);
    const auto in = chunk.in(position);
    const auto out = chunk.out(position);
    std::fill(out.begin(), out.end(), std::byte{0});
    if (!chunk.goes_on()) return false;
    for (unsigned first = 0; first < bricks.voxels(); first += kSiblings) {
      for (unsigned m = first; m < first + kSiblings; ++m) {
        Voxel& one = siblings[m - first];
        one.occupancy = {};
        if (!bricks.exists(m)) continue;
        one.previous = bricks.previous(m);
        if (is_zero(one.previous)) one.previous = {};
        one.around = bricks.around(m, !one.previous.empty());
        one.occupancy =
            model.code_occupancy(chunk.coder, one.around, one.previous, records_of(in, m));
        bricks.set_occupancy(m, one.occupancy);
      }
      for (unsigned m = first; m < first + kSiblings; ++m) {
        Voxel& one = siblings[m - first];
        if (!one.occupancy.any) continue;
        one.around.siblings = bricks.siblings(m);
        model.code(chunk.coder, one.occupancy, one.around, one.previous, records_of(in, m),
                   records_of(out, m));
      }
    }
  }
  return true;
}

template bool code_octree(const ChunkCoding<BinaryEncoder>& chunk);
template bool code_octree(const ChunkCoding<BinaryDecoder>& chunk);

}  // namespace gicodec::native
