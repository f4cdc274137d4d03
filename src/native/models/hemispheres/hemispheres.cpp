// Vertices (docs/native/hemispheres.md).
#include "native/models/chunk_coding.h"
#include "native/models/hemispheres/vertex_neighbours.h"
#include "quantise/set_order.h"

namespace gicodec::native {

template <typename Coder>
bool code_hemispheres(const ChunkCoding<Coder>& chunk) {
  LightModel& model = chunk.memory.light;
  model.reset(chunk.update.desc.record, chunk.memory.values);
  for (std::size_t i = 0; i < chunk.positions.size(); ++i) {
    const std::uint32_t position = chunk.positions[i];
    auto previous = chunk.previous(position);
    if (is_zero(previous)) previous = {};
    const KnownLights around =
        known_around(chunk.update, chunk.positions, i, chunk.records, !previous.empty());
    model.code(chunk.coder, around, previous, chunk.in(position), chunk.out(position));
    if (!chunk.goes_on()) return false;
  }
  return true;
}

template bool code_hemispheres(const ChunkCoding<BinaryEncoder>& chunk);
template bool code_hemispheres(const ChunkCoding<BinaryDecoder>& chunk);

}  // namespace gicodec::native
