// Guard band sections: hostile ones are refused or give whole rings; good ones survive.
#include "stream/border_section.h"

#include "input.h"
#include "texture/guard_band.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  const auto desc = input.desc();
  const bool keyframe = input.below(2) != 0;
  const auto probes = input.probes(desc);
  fuzz::Exact cores(probes.size() * core_bytes(desc)), old(cores.span().size(), 1);
  Mirror mirror(desc);
  mirror.commit(false, probes, old.span(), {});
  const BorderContext context{mirror, keyframe, probes, cores.span()};

  fuzz::Exact section(input.rest());
  StaleRings rings;
  if (read_border_section(desc, probes, section.span(), rings) != Status::ok) return 0;
  resolve_borders(context, rings);
  fuzz::check(!rings.empty(), "a section holds at least one ring");
  fuzz::check(rings.bytes().size() == rings.size() * ring_bytes(desc), "rings are whole");
  for (const std::uint32_t probe : rings.probes()) {
    fuzz::check(std::ranges::binary_search(probes, probe), "rings belong to the update");
  }
  std::vector<std::byte> written;
  fuzz::check(write_border_section(context, rings, written) == Status::ok, "rings can be written");
  fuzz::check(written.size() <= border_section_bound(desc, probes.size(), rings.size()),
              "the bound holds");
  fuzz::Exact exact(written);
  StaleRings back;
  fuzz::check(read_border_section(desc, probes, exact.span(), back) == Status::ok, "and read");
  resolve_borders(context, back);
  fuzz::check(back == rings, "write and read are inverse");
  return 0;
}
