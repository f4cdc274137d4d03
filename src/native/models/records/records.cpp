// Any blocks (docs/native/records.md).
#include "native/models/chunk_coding.h"

namespace gicodec::native {

template <typename Coder>
bool code_records(const ChunkCoding<Coder>& chunk) {
  RecordModel& model = chunk.memory.record;
  model.reset(chunk.update.desc, chunk.update.update, chunk.memory.values);
  for (const std::uint32_t position : chunk.positions) {
    model.code(chunk.coder, chunk.in(position), chunk.out(position), chunk.previous(position),
               chunk.presence(position));
    if (!chunk.goes_on()) return false;
  }
  return true;
}

template bool code_records(const ChunkCoding<BinaryEncoder>& chunk);
template bool code_records(const ChunkCoding<BinaryDecoder>& chunk);

}  // namespace gicodec::native
