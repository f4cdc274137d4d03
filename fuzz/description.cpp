// A container's description and seek index: what is read is written as the same bytes.
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
    if (read_description(body.span(), {}, read) != Status::ok) return 0;
    fuzz::check(write_description(read, again) == Status::ok, "what was read can be written");
  } else {
    std::vector<SeekEntry> index;
    if (read_index_body(body.span(), 3, 40, 1U << 30, index) != Status::ok) return 0;
    write_index(index, again);
  }
  fuzz::check(fuzz::same(again, body.span()), "writing is the inverse of reading");
  return 0;
}
