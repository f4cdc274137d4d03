// Heads of native chunks: what was read is written and read again as the same values. The first
// byte chooses the format.
#include "input.h"

#include "native/chunk_head.h"

namespace {

using namespace gicodec;
using namespace gicodec::native;

bool read(const PlaneLayout& layout, std::span<const std::byte> bytes, ChunkHead& head) {
  ByteReader reader(bytes);
  const auto first = reader.fixed<std::uint8_t>();
  if ((first & 3) != kModelledChunk) return false;
  read_head(layout, first, reader, head);
  if ((first & kHasOverrides) != 0) read_overrides(layout.pairs, reader, head.overrides);
  return reader.ok();
}

bool equal(const ChunkHead& a, const ChunkHead& b) {
  const auto& x = a.overrides;
  const auto& y = b.overrides;
  return a.lanes == b.lanes && a.set == b.set && a.coded == b.coded &&
         std::ranges::equal(a.constant, b.constant) && std::ranges::equal(a.cap, b.cap) &&
         (x.empty() || x.members == y.members) &&
         std::ranges::equal(x.tokens, y.tokens,
                            [](const auto& s, const auto& t) {
                              return s.context == t.context && s.distribution == t.distribution;
                            }) &&
         std::ranges::equal(x.hits, y.hits, [](const auto& s, const auto& t) {
           return s.context == t.context && s.end0 == t.end0 && s.end1 == t.end1;
         });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  TextureDesc desc = probe_texture(input.record(), {1, 1, 1}, 1);
  if (!can_code(desc)) desc.record = Format::A2R10G10B10_UNORM_PACK32;
  const auto layout = plane_layout(desc.record);
  fuzz::Exact bytes(input.rest());
  ChunkHead head, again;
  if (!read(layout, bytes.span(), head)) return 0;
  for (const auto& member : head.overrides.members) {
    std::uint32_t sum = 0;
    for (const auto frequency : member) {
      fuzz::check(frequency != 0, "every token has a frequency");
      sum += frequency;
    }
    fuzz::check(sum == kProbabilityScale, "frequencies fill the scale");
  }
  std::vector<std::byte> written;
  write_head(layout, head, written);
  fuzz::Exact exact(written);
  fuzz::check(read(layout, exact.span(), again) && equal(head, again),
              "writing is the inverse of reading");
  return 0;
}
