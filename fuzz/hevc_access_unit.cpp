// The checks that HEVC access units pass before a decoder sees them: a byte for the picture's
// format, then parts, one access unit each. What is accepted survives append_access_unit().
#include "mutate.h"

#include "backend/hevc/access_unit.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  // Those of hevc_decode's textures.
  constexpr hevc::PictureFormat kFormats[] = {
      {32, 16, 8, false},  {32, 16, 10, false}, {32, 16, 12, false},
      {48, 16, 10, false}, {48, 16, 12, false}, {64, 16, 8, false},
      {128, 16, 8, false}, {32, 64, 8, true},   {32, 256, 8, true}};
  const auto& format = kFormats[input.below(std::size(kFormats))];
  hevc::ParameterSets sets;
  for (int i = 0; i < 4 && !input.empty(); ++i) {
    fuzz::Exact bytes(input.part().bytes);
    auto again_sets = sets;
    const auto unit = parse_access_unit(bytes.span(), format, sets);
    if (!unit) continue;
    fuzz::check(!unit->units.empty(), "an access unit holds something");
    for (const auto& nal : unit->units) {
      fuzz::check(nal.data() >= bytes.span().data() &&
                      nal.data() + nal.size() <= bytes.span().data() + bytes.span().size(),
                  "NAL units lie in the access unit");
    }
    std::vector<std::byte> appended;
    hevc::append_access_unit(bytes.span(), appended);
    const auto again = parse_access_unit(appended, format, again_sets);
    fuzz::check(again.ok() && again->idr == unit->idr && again->units.size() == unit->units.size(),
                "what is accepted is kept");
    for (std::size_t k = 0; k < again->units.size(); ++k) {
      fuzz::check(fuzz::same(again->units[k], unit->units[k]), "NAL unit by NAL unit");
    }
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return gicodec::fuzz::mutate_parts(data, size, max_size, seed, 1, gicodec::fuzz::mutate_blindly);
}
