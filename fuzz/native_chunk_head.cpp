// Heads of native chunks: what was read is written and read again as the same values. The first
// byte chooses the format.
#include "input.h"

#include "native/frame/chunk_head.h"

#include <algorithm>

namespace {

using namespace gicodec;
using namespace gicodec::native;

bool read(const PlaneLayout& layout, std::span<const std::byte> bytes, ChunkHead& head) {
  ByteReader reader(bytes);
  const auto first = reader.fixed<std::uint8_t>();
  if ((first & 3) != kModelledChunk) return false;
  read_head(layout, true, first, reader, head);
  return reader.ok();
}

bool equal(const Overrides& a, const Overrides& b) {
  return std::ranges::equal(a.distributions, b.distributions,
                            [](const auto& s, const auto& t) {
                              return s.number == t.number &&
                                     s.distribution.unit == t.distribution.unit &&
                                     s.distribution.shift == t.distribution.shift &&
                                     std::ranges::equal(s.distribution.units, t.distribution.units);
                            }) &&
         std::ranges::equal(a.contexts, b.contexts, [](const auto& s, const auto& t) {
           return s.context == t.context && s.distribution == t.distribution;
         });
}

bool equal(const OwnRepeats& a, const OwnRepeats& b) {
  if (a.distributions != b.distributions) return false;
  for (unsigned m = 0; m < a.distributions; ++m) {
    if (!std::ranges::equal(a.end[m], b.end[m])) return false;
  }
  return a.distributions == 0 || std::ranges::equal(a.map, b.map);
}

bool equal(const ChunkHead& a, const ChunkHead& b) {
  return a.lanes == b.lanes && a.flat == b.flat && a.coded == b.coded &&
         std::ranges::equal(a.constant, b.constant) && std::ranges::equal(a.frequent, b.frequent) &&
         std::ranges::equal(a.tables.set, b.tables.set) &&
         equal(a.tables.repeats, b.tables.repeats) &&
         std::ranges::equal(a.tables.overrides, b.tables.overrides,
                            [](const auto& s, const auto& t) { return equal(s, t); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const auto layout = plane_layout(probe_texture(input.record(), {1, 1, 1}, 1));
  fuzz::Exact bytes(input.rest());
  ChunkHead head, again;
  if (!read(layout, bytes.span(), head)) return 0;
  for (const auto& overrides : head.tables.overrides) {
    for (const auto& r : overrides.distributions) {
      fuzz::check(r.number < kDistributions && valid(r.distribution), "distributions are valid");
    }
    for (const auto& m : overrides.contexts)
      fuzz::check(m.distribution < kDistributions, "distributions exist");
  }
  const OwnRepeats& repeats = head.tables.repeats;
  for (unsigned m = 0; m < repeats.distributions; ++m) {
    fuzz::check(repeats.end[m][0] > 0 && repeats.end[m][0] < repeats.end[m][1] &&
                    repeats.end[m][1] < kProbabilityScale,
                "every repeat symbol has a frequency");
  }
  std::vector<std::byte> written;
  write_head(layout, head, written);
  fuzz::Exact exact(written);
  fuzz::check(read(layout, exact.span(), again) && equal(head, again),
              "writing is the inverse of reading");
  return 0;
}
