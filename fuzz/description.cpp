// A container's description and index parts: what is read is written as the same bytes.
#include "bitstream/container_format.h"
#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  const bool description = input.below(2) == 0;
  fuzz::Exact body(input.rest());
  std::vector<std::byte> again;
  if (description) {
    ContainerDescription read;
    if (read_description(body.span(), {}, {}, read) != Status::ok) return 0;
    fuzz::check(write_description(read, {}, again) == Status::ok, "what was read can be written");
  } else {
    constexpr PacketRule kRules[] = {{0, true}, {4, true}, {kMaxBlocks, false}};
    constexpr std::uint64_t kFirst = 40, kOffset = 0x3FFFFFFF;
    const auto part = read_index_part(body.span(), kRules, kFirst, kOffset);
    if (!part) return 0;
    write_index_part(*part, kOffset, again);
  }
  fuzz::check(fuzz::same(again, body.span()), "writing is the inverse of reading");
  return 0;
}
