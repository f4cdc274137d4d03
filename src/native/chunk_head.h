// Head of a chunk as bytes.
#pragma once

#include "base/bytes.h"
#include "native/workspace.h"

#include <bit>
#include <vector>

namespace gicodec::native {

inline constexpr std::uint8_t kRawChunk = 0;
inline constexpr std::uint8_t kModelledChunk = 1;

inline constexpr std::uint8_t kHasOverrides = 0x80;

/// The first token has what the others leave; those after the last one listed have 1.
inline void write_member(const Frequencies& f, ByteWriter& writer) {
  unsigned n = kTokens;
  while (n > 1 && f[n - 1] == 1) --n;
  writer.fixed(static_cast<std::uint8_t>(n));
  for (unsigned t = 1; t < n; ++t) writer.varint(f[t] - 1U);
}
inline void read_member(ByteReader& reader, Frequencies& f) {
  const unsigned n = reader.fixed<std::uint8_t>();
  if (n < 1 || n > kTokens) return reader.fail(Status::corrupt);
  unsigned others = 0;
  for (unsigned t = 1; t < kTokens; ++t) {
    f[t] = static_cast<std::uint16_t>(t < n ? 1 + reader.varint(kProbabilityScale) : 1);
    others += f[t];
  }
  if (others >= kProbabilityScale) return reader.fail(Status::corrupt);
  f[0] = static_cast<std::uint16_t>(kProbabilityScale - others);
}

inline void write_overrides(const Overrides& overrides, bool pairs, ByteWriter& writer) {
  writer.fixed(static_cast<std::uint8_t>(overrides.members.size()));
  for (const auto& member : overrides.members) write_member(member, writer);
  writer.varint(overrides.tokens.size());
  unsigned next = 0;
  for (const auto& o : overrides.tokens) {
    writer.varint(o.context - next);
    writer.fixed(o.distribution);
    next = o.context + 1U;
  }
  if (!pairs) return;
  writer.varint(overrides.hits.size());
  for (const auto& o : overrides.hits) {
    writer.fixed(o.context);
    writer.fixed(o.end0);
    writer.fixed(o.end1);
  }
}

inline void read_overrides(bool pairs, ByteReader& reader, Overrides& overrides) {
  const unsigned members = reader.fixed<std::uint8_t>();
  if (members > kMaxMembers) return reader.fail(Status::corrupt);
  overrides.members.resize(members);
  for (auto& member : overrides.members) read_member(reader, member);
  const auto tokens = reader.varint(kContexts);
  unsigned next = 0;
  for (std::uint64_t i = 0; i < tokens && reader.ok(); ++i) {
    const auto context = next + static_cast<unsigned>(reader.varint(kContexts));
    const auto distribution = reader.fixed<std::uint8_t>();
    if (context >= kContexts || distribution >= kDistributions + members)
      return reader.fail(Status::corrupt);
    overrides.tokens.push_back({static_cast<std::uint16_t>(context), distribution});
    next = context + 1;
  }
  if (!pairs) return;
  const auto hits = reader.varint(kHitContexts);
  next = 0;
  for (std::uint64_t i = 0; i < hits && reader.ok(); ++i) {
    const auto context = reader.fixed<std::uint8_t>();
    const auto end0 = reader.fixed<std::uint16_t>();
    const auto end1 = reader.fixed<std::uint16_t>();
    if (!reader.ok()) return;
    if (context < next || context >= kHitContexts || end0 == 0 || end0 >= end1 ||
        end1 >= kProbabilityScale) {
      return reader.fail(Status::corrupt);
    }
    overrides.hits.push_back({context, end0, end1});
    next = context + 1U;
  }
}

inline void write_head(const PlaneLayout& layout, const ChunkHead& head,
                       std::vector<std::byte>& out) {
  ByteWriter writer(out);
  writer.fixed(static_cast<std::uint8_t>(kModelledChunk | std::countr_zero(head.lanes) << 2 |
                                         head.set << 5 |
                                         (head.overrides.empty() ? 0 : kHasOverrides)));
  if (layout.pairs) {
    for (const auto cap : head.cap) writer.fixed(cap);
  } else {
    writer.fixed(head.coded);
    for (unsigned p = 0; p < layout.planes; ++p) {
      if ((head.coded >> p & 1) == 0) writer.fixed(head.constant[p]);
    }
  }
  if (!head.overrides.empty()) write_overrides(head.overrides, layout.pairs, writer);
}

inline void read_planes(const PlaneLayout& layout, ByteReader& reader, ChunkHead& head) {
  head.coded = reader.fixed<std::uint8_t>();
  if (head.coded >> layout.planes != 0) return reader.fail(Status::corrupt);
  for (unsigned p = 0; p < layout.planes; ++p) {
    if ((head.coded >> p & 1) != 0) continue;
    head.constant[p] = reader.fixed<std::uint16_t>();
    if (head.constant[p] >> (layout.plane[p].bits - 1) > 1) reader.fail(Status::corrupt);
  }
}

/// Up to the overrides. `first` is the byte that said kModelledChunk.
inline void read_head(const PlaneLayout& layout, std::uint8_t first, ByteReader& reader,
                      ChunkHead& head) {
  const unsigned log2_lanes = first >> 2 & 7;
  head.set = first >> 5 & 3;
  if (log2_lanes > 5) return reader.fail(Status::corrupt);
  head.lanes = 1U << log2_lanes;
  if (layout.pairs) {
    for (auto& cap : head.cap) cap = reader.fixed<std::uint16_t>();
    head.coded = 3;
  } else {
    read_planes(layout, reader, head);
  }
}

}  // namespace gicodec::native
