// Guard band sections: hostile ones are refused or give whole bands; good ones survive.
#include "stream/guard_band_section.h"
#include "stream/mirror.h"

#include "input.h"
#include "texture/guard_band.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  const auto desc = input.desc();
  const bool keyframe = input.below(2) != 0;
  const auto blocks = input.blocks(desc);
  fuzz::Exact records(blocks.size() * block_bytes(desc)), old(records.span().size(), 1);
  Mirror mirror(desc);
  Vector<std::byte> held(old.span().begin(), old.span().end());
  mirror.commit(false, blocks, held, {}, {});
  const StaleBands before;
  const BlockTable table{records.span().data(), block_bytes(desc)};
  const GuardBandContext context{desc, keyframe, blocks, table, mirror.blocks(), before};

  fuzz::Exact section(input.rest());
  StaleBands bands;
  GuardBandMemory memory;
  if (read_guard_band_section(desc, blocks, section.span(), memory, bands) != Status::ok) return 0;
  resolve_guard_bands(context, bands);
  fuzz::check(!bands.empty(), "a section holds at least one band");
  fuzz::check(bands.bytes().size() == bands.size() * band_bytes(desc), "bands are whole");
  for (const std::uint32_t block : bands.blocks()) {
    fuzz::check(std::ranges::binary_search(blocks, block), "bands belong to the update");
  }
  std::vector<std::byte> written;
  fuzz::check(write_guard_band_section(context, bands, memory, written) == Status::ok,
              "bands can be written");
  fuzz::check(written.size() <= guard_band_section_bound(desc, blocks.size(), bands.size()),
              "the bound holds");
  fuzz::Exact exact(written);
  StaleBands back;
  fuzz::check(read_guard_band_section(desc, blocks, exact.span(), memory, back) == Status::ok,
              "and read");
  resolve_guard_bands(context, back);
  fuzz::check(back == bands, "write and read are inverse");
  return 0;
}
