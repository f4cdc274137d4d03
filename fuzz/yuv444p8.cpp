// Rows of texel bytes ↔ YUV444P8.
#include "inverses.h"

#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  const auto broken = test::broken_yuv444p8(std::as_bytes(std::span(data, size)));
  fuzz::check(broken.empty(), broken.data());
  return 0;
}
