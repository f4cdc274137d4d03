// Bricks of voxels (docs/native.md, "Voxels").
#include "native/models/chunk_coding.h"
#include "quantise/set_order.h"

#include <algorithm>
#include <array>

namespace gicodec::native {

/// Brick by brick, family by family: where each voxel of a family has light, then the light of
/// those that have.
template <typename Coder>
bool code_octree(const ChunkCoding<Coder>& chunk) {
  constexpr unsigned kFamily = KnownLights::kChildren;
  struct Voxel {
    std::span<const std::byte> past;
    KnownLights around;
    ToldLight told;
  };
  std::array<Voxel, kFamily> family;
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
    for (unsigned first = 0; first < bricks.voxels(); first += kFamily) {
      for (unsigned m = first; m < first + kFamily; ++m) {
        Voxel& one = family[m - first];
        one.told = {};
        if (!bricks.exists(m)) continue;
        one.past = bricks.past(m);
        if (is_zero(one.past)) one.past = {};
        one.around = bricks.around(m, !one.past.empty());
        one.told = model.tell(chunk.coder, one.around, one.past, records_of(in, m));
        bricks.tell(m, one.told);
      }
      for (unsigned m = first; m < first + kFamily; ++m) {
        Voxel& one = family[m - first];
        if (!one.told.any) continue;
        one.around.family = bricks.family(m);
        model.code(chunk.coder, one.told, one.around, one.past, records_of(in, m),
                   records_of(out, m));
      }
    }
  }
  return true;
}

template bool code_octree(const ChunkCoding<BinaryEncoder>& chunk);
template bool code_octree(const ChunkCoding<BinaryDecoder>& chunk);

}  // namespace gicodec::native
