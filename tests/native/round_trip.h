// Payloads: exact for everything, the same bytes on every instruction set and number of threads,
// and what the reference decoder reads.
#pragma once

#include "native/content.h"

namespace gicodec::test {

[[nodiscard]] Bytes decode(const UpdateCase& u, std::span<const std::byte> payload,
                           unsigned threads, Isa isa);
/// Encodes on several instruction sets and numbers of threads, and decodes by each and by the
/// reference decoder.
void check_everything(UpdateCase u, native::PayloadSettings settings);
/// A keyframe, an update or an intra one, by the seed.
[[nodiscard]] UpdateCase any_update(const TextureDesc& desc, Content content, std::uint32_t one_in,
                                    std::uint64_t seed);

}  // namespace gicodec::test
