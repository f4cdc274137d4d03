// The decoding side of one backend on hostile payloads: keyframes and updates of one session, each
// also decoded by a session that saw nothing before.
#pragma once

#include "mutate.h"

namespace gicodec::fuzz {

inline constexpr std::size_t kPayloadHead = 6;

/// The input: a description, then parts of a flag byte (bit 0: keyframe, bit 1 as well: a fresh
/// update), blocks and payload.
/// fresh() gives a new session; each session is a function of a job that returns its status.
template <typename Describe, typename Fresh>
int fuzz_payloads(const std::uint8_t* data, std::size_t size, const Describe& describe,
                  const Fresh& fresh) {
  Input input(data, size);
  const auto desc = describe(input);
  const auto presence = input.presence(desc);
  const std::size_t block = block_bytes(desc);
  Exact mirror(block_count(desc) * block);
  std::ranges::fill(mirror.span(), std::byte{0});
  std::vector<std::uint8_t> received(block_count(desc));
  auto kept = fresh(desc);
  for (int i = 0; i < 6 && !input.empty(); ++i) {
    Input part(input.part().bytes);
    const auto kind = part.byte();
    const bool keyframe = (kind & 1) != 0, independent = (kind & 3) == 3;
    const auto blocks = part.blocks(desc);
    Exact payload(part.rest());
    Exact records(blocks.size() * block, 0), again(records.span().size(), 1);
    std::vector<std::byte> exists;
    const std::size_t per_block = presence_bytes(desc);
    for (const auto b : blocks) {
      const auto one = std::span(presence).subspan(b * per_block, per_block);
      exists.insert(exists.end(), one.begin(), one.end());
    }
    // A keyframe must not look at the mirror: one of the two has none, or another of its blocks.
    Exact changed(mirror.span());
    scatter(desc, blocks, again.span(), changed.span());
    const BlockTable existed{presence.data(), per_block};
    const MirrorView held{{mirror.span().data(), block}, received.data(), existed};
    const MirrorView others{{changed.span().data(), block}, received.data(), existed};
    const MirrorView known = independent ? others : keyframe ? MirrorView{} : held;
    const DecodeJob job{.desc = desc,
                        .blocks = blocks,
                        .payload = payload.span(),
                        .mirror = held,
                        .records = records.span(),
                        .keyframe = keyframe,
                        .intra = independent,
                        .presence = exists};
    const Status status = kept(job);
    const DecodeJob same_job{.desc = desc,
                             .blocks = blocks,
                             .payload = payload.span(),
                             .mirror = known,
                             .records = again.span(),
                             .keyframe = keyframe,
                             .intra = independent,
                             .presence = exists};
    check(fresh(desc)(same_job) == status, "one verdict, whatever was decoded before");
    if (status != Status::ok) continue;
    check(same(records.span(), again.span()), "every record is written, from the payload alone");
    if (keyframe && !independent) {
      std::ranges::fill(mirror.span(), std::byte{0});
      std::ranges::fill(received, std::uint8_t{0});
    }
    scatter(desc, blocks, records.span(), mirror.span());
    for (const auto b : blocks) received[b] = 1;
  }
  return 0;
}

inline int fuzz_payload(std::uint8_t backend_id, const std::uint8_t* data, std::size_t size) {
  const auto* backend = *std::ranges::find(built_in_backends(), backend_id, &Backend::id);
  const auto describe = [](Input& input) { return input.any_desc(); };
  return fuzz_payloads(data, size, describe, [&](const TextureDesc& desc) {
    auto made = backend->make_decoder(desc);
    check(made.ok(), "a byte backend takes every texture");
    return [decoder = std::shared_ptr<BackendDecoder>(*std::move(made))](const DecodeJob& job) {
      return decoder->decode(job);
    };
  });
}

inline std::size_t mutate_payloads(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                   unsigned seed) {
  return mutate_parts(data, size, max_size, seed, kPayloadHead, mutate_blindly);
}

}  // namespace gicodec::fuzz
