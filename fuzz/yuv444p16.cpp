// A2RGB10 ↔ YUV444P16 on any words: a byte chooses packing and alignment.
#include "inverses.h"

#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  const auto choice = input.byte();
  const auto rest = input.rest();
  std::vector<std::uint32_t> words(rest.size() / 4);
  if (!words.empty()) std::memcpy(words.data(), rest.data(), 4 * words.size());
  const auto broken = test::broken_yuv444p16(
      (choice & 1) != 0 ? Format::A2R10G10B10_UNORM_PACK32 : Format::A2B10G10R10_UNORM_PACK32,
      (choice & 2) != 0 ? SampleAlignment::high : SampleAlignment::low, words);
  fuzz::check(broken.empty(), broken.data());
  return 0;
}
