#include "native/matches/byte_order.h"
#include "native/matches/match_chunk.h"
#include "native/matches/match_model.h"

namespace gicodec::native {

bool takes_matches(const TextureDesc& desc) noexcept { return desc.presence == Presence::all; }

Status decode_matches(const Update& u, std::span<const std::uint32_t> positions,
                      std::span<const std::byte> bytes, std::span<std::byte> texels,
                      MatchMemory& memory) {
  if (!takes_matches(u.desc)) return Status::corrupt;
  BinaryDecoder coder(bytes);
  const ByteOrder order{static_cast<Difference>(coder.bypass(2)), coder.bypass(1) != 0};
  const auto literals = static_cast<Literals>(coder.bypass(2));
  if (order.difference == Difference::past && !u.update) return Status::corrupt;
  MatchModel model(literals, distances_of(u.desc, order, positions.size()), memory.trees);
  const std::size_t block = u.block_bytes();
  ByteWalk to(u, positions, {texels.data(), block}, order), from = to;
  std::uint8_t last = 0;
  const auto store = [&](std::uint8_t difference) {
    last = difference;
    texels[to.position() * block + to.at()] = to.byte_of(difference);
    to.step();
  };
  const std::size_t size = to.size();
  for (std::size_t done = 0; done < size;) {
    if (coder.overrun()) return Status::truncated;
    if (u.cancelled()) return Status::cancelled;
    const CodedMatch match = model.match(coder, to.byte(), {});
    if (match.length == 0) {
      store(model.literal(coder, to.byte(), last, 0));
      ++done;
      continue;
    }
    if (match.distance > done || match.length > size - done)
      return coder.overrun() ? Status::truncated : Status::corrupt;
    done += match.length;
    if (match.distance == 0) {
      for (std::uint32_t i = 0; i < match.length; ++i) store(0);
      continue;
    }
    from.seek(done - match.length - static_cast<std::size_t>(match.distance));
    for (std::uint32_t i = 0; i < match.length; ++i) {
      store(from.difference());
      from.step();
    }
  }
  if (coder.overrun()) return Status::truncated;
  return coder.ended() ? Status::ok : Status::corrupt;
}

}  // namespace gicodec::native
