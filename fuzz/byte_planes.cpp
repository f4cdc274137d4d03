// Texels of any format ↔ byte planes: a byte for the format, one that says whether the second half
// of the rest is the reference of the first.
#include "inverses.h"

#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  const auto& format = formats()[input.below(static_cast<std::uint32_t>(formats().size()))];
  const bool difference = input.below(2) != 0;
  const auto rest = input.rest();
  const std::size_t texel = format.texel_bytes;
  const std::size_t used = rest.size() / (difference ? 2 : 1) / texel * texel;
  fuzz::Exact reference(rest.subspan(rest.size() - (difference ? used : 0)));
  const auto broken = test::broken_byte_planes(format.format, rest.first(used), reference.span());
  fuzz::check(broken.empty(), broken.data());
  return 0;
}
