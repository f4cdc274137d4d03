// Updates of made-up probe textures for the native codec's tests.
#pragma once

#include "native/payload.h"
#include "support.h"

namespace gicodec::test {

/// What a codec sees in practice and what hurts it.
enum class Content { smooth, noisy, white, constant, extremes, alternating };
inline constexpr Content kContents[] = {Content::smooth,   Content::noisy,    Content::white,
                                        Content::constant, Content::extremes, Content::alternating};

/// Core texels of every probe at frame 0, 1, ...
[[nodiscard]] Bytes make_cores(const TextureDesc& desc, Content content, unsigned frame,
                               std::uint64_t seed);

/// One update, with its own memory.
struct UpdateCase {
  TextureDesc desc;
  std::vector<std::uint32_t> probes;
  Bytes texels, mirror;
  bool keyframe = false;

  [[nodiscard]] EncodeJob encode_job() { return {desc, probes, texels, mirror, keyframe}; }
  [[nodiscard]] DecodeJob decode_job(std::span<const std::byte> payload,
                                     std::span<std::byte> out) const {
    return {desc, probes, payload, mirror, out, keyframe};
  }
};
/// About one in `one_in` of the probes.
[[nodiscard]] UpdateCase make_update(const TextureDesc& desc, Content content, bool keyframe,
                                     std::uint32_t one_in, std::uint64_t seed);
[[nodiscard]] Bytes encode(UpdateCase& update, const native::PayloadSettings& settings, Isa isa);

/// Any format, odd sides, small grids.
[[nodiscard]] TextureDesc any_desc(Random& random);

}  // namespace gicodec::test
