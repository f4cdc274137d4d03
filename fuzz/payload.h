// The decoding side of one backend on hostile payloads: keyframes and updates of one session, each
// also decoded by a session that saw nothing before.
#pragma once

#include "mutate.h"

namespace gicodec::fuzz {

inline constexpr std::size_t kPayloadHead = 6;

/// The input: a description, then parts of a flag byte (bit 0: keyframe), probes and payload.
/// fresh() gives a new session; each session is a function of a job that returns its status.
template <typename Fresh>
int fuzz_payloads(const std::uint8_t* data, std::size_t size, const Fresh& fresh) {
  Input input(data, size);
  const auto desc = input.desc();
  Exact mirror(probe_count(desc) * core_bytes(desc));
  auto kept = fresh(desc);
  for (int i = 0; i < 6 && !input.empty(); ++i) {
    Input part(input.part().bytes);
    const bool keyframe = (part.byte() & 1) != 0;
    const auto probes = part.probes(desc);
    Exact payload(part.rest());
    Exact texels(probes.size() * core_bytes(desc), 0), again(texels.span().size(), 1);
    // A keyframe must not look at the mirror: one of the two has none.
    const auto known = keyframe ? std::span<const std::byte>{} : mirror.span();
    const Status status =
        kept({desc, probes, payload.span(), mirror.span(), texels.span(), keyframe});
    check(fresh(desc)({desc, probes, payload.span(), known, again.span(), keyframe}) == status,
          "one verdict, whatever was decoded before");
    if (status != Status::ok) continue;
    check(same(texels.span(), again.span()), "every texel is written, from the payload alone");
    if (keyframe) std::ranges::fill(mirror.span(), std::byte{0});
    scatter(desc, probes, texels.span(), mirror.span());
  }
  return 0;
}

inline int fuzz_payload(std::uint8_t backend_id, const std::uint8_t* data, std::size_t size) {
  const auto* backend = *std::ranges::find(built_in_backends(), backend_id, &Backend::id);
  return fuzz_payloads(data, size, [&](const TextureDesc& desc) {
    auto made = backend->make_decoder(desc);
    check(made.ok(), "a built-in backend takes every format");
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
