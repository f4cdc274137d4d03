// Whatever the texels, they come back, within the bound, from the same bytes on every instruction
// set.
#include "input.h"

#include "native/payload.h"

#include <numeric>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  using namespace gicodec::fuzz;
  Input input(data, size);
  const auto desc = input.desc();
  const bool keyframe = input.below(2) != 0;
  native::PayloadSettings settings;
  settings.chunk.strong = input.below(2) != 0;
  std::vector<std::uint32_t> probes(input.below(probe_count(desc) + 1));
  std::iota(probes.begin(), probes.end(), 0U);
  // What the input holds, over and over: first the mirror, then the texels.
  const auto rest = input.rest();
  std::size_t at = 0;
  const auto fill = [&](std::span<std::byte> to) {
    for (auto& b : to) b = rest.empty() ? std::byte{0} : rest[at++ % rest.size()];
  };
  Exact mirror(keyframe ? 0 : probe_count(desc) * core_bytes(desc));
  Exact texels(probes.size() * core_bytes(desc));
  fill(mirror.span());
  fill(texels.span());

  std::vector<std::byte> first;
  for (const Isa isa : supported_isas()) {
    std::vector<native::Workspace> workspaces;
    std::vector<std::byte> out;
    native::encode_payload({desc, probes, texels.span(), mirror.span(), keyframe}, settings, isa,
                           workspaces, out);
    check(out.size() <= native::payload_bound(desc, probes.size()), "within the bound");
    if (isa == Isa::scalar) first = out;
    check(out == first, "the same bytes on every instruction set");
    Exact payload(out), back(texels.span().size());
    check(
        native::decode_payload({desc, probes, payload.span(), mirror.span(), back.span(), keyframe},
                               isa, workspaces) == Status::ok,
        "own payloads decode");
    check(std::ranges::equal(back.span(), texels.span()), "exactly");
  }
  return 0;
}
