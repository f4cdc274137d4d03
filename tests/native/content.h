// Updates of made-up textures for the native codec's tests.
#pragma once

#include "native/frame/payload.h"
#include "support.h"

namespace gicodec::test {

/// What a codec sees in practice and what hurts it.
enum class Content { smooth, noisy, white, constant, extremes, alternating, stepped, shared };
inline constexpr Content kContents[] = {Content::smooth,   Content::noisy,    Content::white,
                                        Content::constant, Content::extremes, Content::alternating,
                                        Content::stepped,  Content::shared};

/// Records of every block at frame 0, 1, ...
[[nodiscard]] Bytes make_records(const TextureDesc& desc, Content content, unsigned frame,
                                 std::uint64_t seed);

/// One update, with its own memory.
struct UpdateCase {
  TextureDesc desc;
  std::vector<std::uint32_t> blocks;
  Bytes records, mirror;
  std::vector<std::uint8_t> received;  ///< blocks of the mirror; the others are zero in it
  bool keyframe = false;
  Bytes presence;  ///< of `blocks`; what does not exist is zero
  bool intra = false;
  Bytes mirror_presence = {};  ///< of bricks, of every block of the mirror

  [[nodiscard]] BlockTable table(const Bytes& of) const { return {of.data(), block_bytes(desc)}; }
  [[nodiscard]] MirrorView held() const {
    const BlockTable existed{mirror_presence.data(),
                             mirror_presence.empty() ? 0 : presence_bytes(desc)};
    return {table(mirror), received.data(), existed};
  }
  [[nodiscard]] EncodeJob encode_job() const {
    return {.desc = desc,
            .blocks = blocks,
            .records = table(records),
            .mirror = held(),
            .keyframe = keyframe,
            .intra = intra,
            .presence = presence};
  }
  [[nodiscard]] DecodeJob decode_job(std::span<const std::byte> payload,
                                     std::span<std::byte> out) const {
    return {.desc = desc,
            .blocks = blocks,
            .payload = payload,
            .mirror = held(),
            .records = out,
            .keyframe = keyframe,
            .intra = intra,
            .presence = presence};
  }
};
/// Of a mirror that holds every block: all were received, or a third were not and are zero.
void forget_some(UpdateCase& update, Random& random);
/// About one in `one_in` of the blocks; of a mirror, some blocks or all were received.
[[nodiscard]] UpdateCase make_update(const TextureDesc& desc, Content content, bool keyframe,
                                     std::uint32_t one_in, std::uint64_t seed);
/// An intra one: the mirror holds anything of its blocks.
[[nodiscard]] UpdateCase make_intra(const TextureDesc& desc, Content content, std::uint32_t one_in,
                                    std::uint64_t seed);
/// Puts the records of every block, which is a set, into the canonical order.
void sort_sets(UpdateCase& update);
/// A mirror some of whose records are retained, unchanged or at their places alone.
void make_previous(UpdateCase& u, Random& random, bool sorted);
[[nodiscard]] Bytes encode(const UpdateCase& update, const native::PayloadSettings& settings,
                           Isa isa);

}  // namespace gicodec::test
