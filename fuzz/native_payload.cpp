// The native decoder on hostile payloads, on every instruction set: one verdict, one result.
#include "input.h"

#include "native/payload.h"

#include <numeric>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  using namespace gicodec::fuzz;
  Input input(data, size);
  const auto desc = input.desc();
  const bool keyframe = input.below(2) != 0;
  std::vector<std::uint32_t> probes(input.below(probe_count(desc) + 1));
  std::iota(probes.begin(), probes.end(), probe_count(desc) - probes.size());
  Exact mirror(probe_count(desc) * core_bytes(desc));
  for (std::size_t i = 0; i < mirror.span().size(); ++i) mirror.span()[i] = std::byte(i * 7);
  Exact payload(input.rest());

  Exact first(probes.size() * core_bytes(desc));
  Status verdict = Status::ok;
  for (const Isa isa : supported_isas()) {
    Exact texels(first.span().size());
    std::vector<native::Workspace> workspaces;
    const DecodeJob job{desc, probes, payload.span(), mirror.span(), texels.span(), keyframe};
    const Status status = native::decode_payload(job, isa, workspaces);
    if (isa == Isa::scalar) {
      verdict = status;
      std::ranges::copy(texels.span(), first.span().begin());
    }
    check(status == verdict, "the same verdict on every instruction set");
    check(status != Status::ok || std::ranges::equal(texels.span(), first.span()),
          "the same texels on every instruction set");
  }
  return 0;
}
