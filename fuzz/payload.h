// The decoding side of one backend on hostile payloads, for keyframes and updates.
#pragma once

#include "input.h"

#include <numeric>

namespace gicodec::fuzz {

inline int fuzz_payload(std::uint8_t backend_id, const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const auto desc = input.desc();
  const bool keyframe = input.below(2) != 0;
  std::vector<std::uint32_t> probes(input.below(probe_count(desc) + 1));
  std::iota(probes.begin(), probes.end(), probe_count(desc) - probes.size());
  const auto backends = built_in_backends();
  const auto* backend = *std::ranges::find(backends, backend_id, &Backend::id);
  auto decoder = backend->make_decoder(desc);
  check(decoder.ok(), "a byte backend takes every format");

  Exact mirror(probe_count(desc) * core_bytes(desc));
  for (std::size_t i = 0; i < mirror.span().size(); ++i) mirror.span()[i] = std::byte(i * 7);
  Exact payload(input.rest());
  Exact texels(probes.size() * core_bytes(desc));
  const DecodeJob job{desc, probes, payload.span(), mirror.span(), texels.span(), keyframe};
  const Status first = (*decoder)->decode(job);
  // Byte backends have no state: the same again is the same again.
  Exact again(texels.span().size());
  const DecodeJob second{desc, probes, payload.span(), mirror.span(), again.span(), keyframe};
  check((*decoder)->decode(second) == first, "decoding is repeatable");
  check(first != Status::ok || std::ranges::equal(texels.span(), again.span()),
        "every texel is written");
  return 0;
}

}  // namespace gicodec::fuzz
