// Head of a chunk as bytes.
#pragma once

#include "base/bytes.h"
#include "native/workspace.h"

#include <bit>
#include <vector>

namespace gicodec::native {

inline constexpr std::uint8_t kRawChunk = 0;
inline constexpr std::uint8_t kModelledChunk = 1;

inline void write_head(const PlaneLayout& layout, const ChunkHead& head, std::vector<std::byte>& out) {
  ByteWriter writer(out);
  writer.fixed(static_cast<std::uint8_t>(kModelledChunk | std::countr_zero(head.lanes) << 2 |
                                         head.set << 5));
  if (layout.pairs) {
    for (const auto cap : head.cap) writer.fixed(cap);
    return;
  }
  writer.fixed(head.coded);
  for (unsigned p = 0; p < layout.planes; ++p) {
    if ((head.coded >> p & 1) == 0) writer.fixed(head.constant[p]);
  }
}

/// `first` is the byte that said kModelledChunk.
inline void read_head(const PlaneLayout& layout, std::uint8_t first, ByteReader& reader,
                      ChunkHead& head) {
  const unsigned log2_lanes = first >> 2 & 7;
  head.set = first >> 5;
  if (log2_lanes > 5 || head.set >= kSets) return reader.fail(Status::corrupt);
  head.lanes = 1U << log2_lanes;
  if (layout.pairs) {
    for (auto& cap : head.cap) cap = reader.fixed<std::uint16_t>();
    head.coded = 3;
    return;
  }
  head.coded = reader.fixed<std::uint8_t>();
  if (head.coded >> layout.planes != 0) return reader.fail(Status::corrupt);
  for (unsigned p = 0; p < layout.planes; ++p) {
    if ((head.coded >> p & 1) != 0) continue;
    head.constant[p] = reader.fixed<std::uint16_t>();
    if (head.constant[p] >> (layout.plane[p].bits - 1) > 1) reader.fail(Status::corrupt);
  }
}

}  // namespace gicodec::native
