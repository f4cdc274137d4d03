// peek() and verify_checksum() on any bytes.
#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  const std::span packet(reinterpret_cast<const std::byte*>(data), size);
  (void)verify_checksum(packet);
  const auto info = peek(packet);
  if (!info) return 0;
  fuzz::check(info->header_size + info->index_size + info->border_size + info->payload_size == size,
              "the sizes of a packet's parts add up to its size");
  fuzz::check(info->sequence > info->reference, "a packet builds on an earlier one");
  fuzz::check(info->keyframe == (info->reference == 0), "only keyframes need no reference");
  return 0;
}
