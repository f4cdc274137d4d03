// Any records ↔ byte planes: a byte for the record, one that says whether the second half
// of the rest is the reference of the first.
#include "inverses.h"

#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  const Record record = input.record();
  const bool difference = input.below(2) != 0;
  const auto rest = input.rest();
  const std::size_t texel = record.bytes;
  const std::size_t used = rest.size() / (difference ? 2 : 1) / texel * texel;
  fuzz::Exact reference(rest.subspan(rest.size() - (difference ? used : 0)));
  const auto broken = test::broken_byte_planes(record, rest.first(used), reference.span());
  fuzz::check(broken.empty(), broken.data());
  return 0;
}
