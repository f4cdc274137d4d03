// Blocks that are sets (docs/native/unordered.md).
#include "native/models/chunk_coding.h"

#include <algorithm>

namespace gicodec::native {

template <typename Coder>
bool code_unordered(const ChunkCoding<Coder>& chunk) {
  const TextureDesc& desc = chunk.update.desc;
  SetUpdate& model = chunk.memory.set;
  model.reset(chunk.memory.values);
  for (const std::uint32_t position : chunk.positions) {
    const auto previous = chunk.previous(position);
    const std::size_t present =
        BlockPresence(desc, chunk.presence(position)).count() * std::size_t{desc.record.bytes};
    if constexpr (Coder::kDecodes) {
      const auto block = chunk.out(position);
      std::fill(block.begin() + static_cast<std::ptrdiff_t>(present), block.end(), std::byte{0});
      if (!model.decode(chunk.coder, desc.record, previous, block.first(present))) return false;
    } else {
      model.encode(chunk.coder, desc.record, previous, chunk.in(position).first(present));
    }
    if (!chunk.goes_on()) return false;
  }
  return true;
}

template bool code_unordered(const ChunkCoding<BinaryEncoder>& chunk);
template bool code_unordered(const ChunkCoding<BinaryDecoder>& chunk);

}  // namespace gicodec::native
