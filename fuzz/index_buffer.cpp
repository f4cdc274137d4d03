// Index buffers: hostile bytes give ascending indices in range or an error; what was decoded can
// be encoded again, within the bound.
#include "bitstream/index_buffer.h"
#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  const auto mode = static_cast<IndexMode>(input.below(4));
  const std::uint32_t total = 1 + input.u16();
  const std::uint32_t count = input.u16();
  fuzz::Exact bytes(input.rest());
  Vector<std::uint32_t> blocks;
  if (decode_index_buffer(mode, count, total, bytes.span(), blocks) != Status::ok) return 0;
  fuzz::check(blocks.size() == count, "as many indices as announced");
  fuzz::check(blocks.empty() || blocks.back() < total, "indices are in range");
  fuzz::check(std::ranges::adjacent_find(blocks, std::greater_equal<>()) == blocks.end(),
              "indices ascend");

  std::vector<std::byte> again;
  const auto best = encode_index_buffer(blocks, total, again);
  fuzz::check(again.size() <= index_buffer_bound(total), "the bound holds");
  fuzz::check(again.size() <= bytes.span().size(), "the encoder takes the smallest mode");
  fuzz::Exact exact(again);
  Vector<std::uint32_t> back;
  fuzz::check(
      decode_index_buffer(best, count, total, exact.span(), back) == Status::ok && back == blocks,
      "encode and decode are inverse");
  return 0;
}
