// Head of a chunk as bytes (docs/native.md, "Chunk").
#pragma once

#include "base/bytes.h"
#include "native/workspace.h"

#include <bit>
#include <vector>

namespace gicodec::native {

inline constexpr std::uint8_t kRawChunk = 0;
inline constexpr std::uint8_t kModelledChunk = 1;
inline constexpr std::uint8_t kAdaptiveChunk = 2;

inline constexpr std::uint8_t kHasOverrides = 0x20;
inline constexpr std::uint8_t kFlat = 0x40;
inline constexpr std::uint8_t kHasHits = 0x80;

/// Whether a chunk has symbols in that place that a static set is for.
inline bool used_place(const PlaneLayout& layout, bool update, const ChunkHead& head,
                       unsigned place) {
  if (place == kModePlace) return !layout.pairs || update;
  if (layout.pairs) return place != kHitPlace || head.tables.hits.members == 0;
  for (unsigned p = 0; p < layout.planes; ++p) {
    if ((head.coded >> p & 1) != 0 && place_of(p, layout.low) == place) return true;
  }
  return false;
}

inline void write_member(const Member& m, ByteWriter& writer) {
  const unsigned n = listed_symbols(m);
  writer.fixed(static_cast<std::uint16_t>(m.shift | m.unit << 3 | n << 6));
  for (unsigned s = 0; s < n; ++s) writer.fixed(m.units[s]);
  writer.fixed(m.units[kEscape]);
}
inline void read_member(ByteReader& reader, Member& m) {
  const auto form = reader.fixed<std::uint16_t>();
  const unsigned n = form >> 6;
  m = {static_cast<std::uint8_t>(form >> 3 & 7), static_cast<std::uint8_t>(form & 7), {}};
  if (n > kEscape) return reader.fail(Status::corrupt);
  for (unsigned s = 0; s < n; ++s) m.units[s] = reader.fixed<std::uint8_t>();
  m.units[kEscape] = reader.fixed<std::uint8_t>();
  if (reader.ok() && !valid(m)) reader.fail(Status::corrupt);
}

inline void write_overrides(const Overrides& overrides, ByteWriter& writer) {
  writer.fixed(static_cast<std::uint8_t>(overrides.members.size()));
  for (const auto& r : overrides.members) {
    writer.fixed(r.number);
    write_member(r.member, writer);
  }
  writer.fixed(static_cast<std::uint16_t>(overrides.contexts.size()));
  for (const auto& m : overrides.contexts) {
    writer.fixed(m.context);
    writer.fixed(m.member);
  }
}
inline void read_overrides(ByteReader& reader, Overrides& overrides) {
  const unsigned members = reader.fixed<std::uint8_t>();
  if (members > kMembers) return reader.fail(Status::corrupt);
  unsigned next = 0;
  for (unsigned i = 0; i < members && reader.ok(); ++i) {
    Overrides::Replaced r{reader.fixed<std::uint8_t>(), {}};
    if (r.number < next || r.number >= kMembers) return reader.fail(Status::corrupt);
    read_member(reader, r.member);
    overrides.members.push_back(r);
    next = r.number + 1U;
  }
  const unsigned contexts = reader.fixed<std::uint16_t>();
  if (contexts > kContexts) return reader.fail(Status::corrupt);
  next = 0;
  for (unsigned i = 0; i < contexts && reader.ok(); ++i) {
    const auto context = reader.fixed<std::uint8_t>();
    const auto member = reader.fixed<std::uint8_t>();
    if (context < next || member >= kMembers) return reader.fail(Status::corrupt);
    overrides.contexts.push_back({context, member});
    next = context + 1U;
  }
}

inline void write_hits(const OwnHits& hits, ByteWriter& writer) {
  writer.fixed(static_cast<std::uint8_t>(hits.members));
  for (unsigned m = 0; m < hits.members; ++m) {
    for (const auto end : hits.end[m]) writer.fixed(end);
  }
  for (unsigned c = 0; c < kHitContexts; c += 2) {
    writer.fixed(static_cast<std::uint8_t>(hits.map[c] | hits.map[c + 1] << 4));
  }
}
inline void read_hits(ByteReader& reader, OwnHits& hits) {
  hits.members = reader.fixed<std::uint8_t>();
  if (hits.members < 1 || hits.members > kMembers) return reader.fail(Status::corrupt);
  for (unsigned m = 0; m < hits.members; ++m) {
    for (auto& end : hits.end[m]) end = reader.fixed<std::uint16_t>();
    const auto& [end0, end1] = hits.end[m];
    if (end0 == 0 || end0 >= end1 || end1 >= kProbabilityScale) {
      return reader.fail(Status::corrupt);
    }
  }
  for (unsigned c = 0; c < kHitContexts; c += 2) {
    const auto both = reader.fixed<std::uint8_t>();
    hits.map[c] = both & 15;
    hits.map[c + 1] = both >> 4;
    if (hits.map[c] >= hits.members || hits.map[c + 1] >= hits.members) {
      return reader.fail(Status::corrupt);
    }
  }
}

inline void write_head(const PlaneLayout& layout, const ChunkHead& head,
                       std::vector<std::byte>& out) {
  const TableChoice& tables = head.tables;
  ByteWriter writer(out);
  writer.fixed(static_cast<std::uint8_t>(
      kModelledChunk | std::countr_zero(head.lanes) << 2 | (head.flat ? kFlat : 0) |
      (tables.overridden() ? kHasOverrides : 0) | (tables.hits.members > 0 ? kHasHits : 0)));
  for (unsigned p = 0; p < kPlaces; p += 2) {
    writer.fixed(static_cast<std::uint8_t>(tables.set[p] | tables.set[p + 1] << 4));
  }
  if (layout.pairs) {
    for (const auto cap : head.cap) writer.fixed(cap);
  } else {
    for (unsigned p = 0; p < layout.planes; p += 8) {
      writer.fixed(static_cast<std::uint8_t>(head.coded >> p));
    }
    for (unsigned p = 0; p < layout.planes; ++p) {
      if ((head.coded >> p & 1) == 0) writer.fixed(head.constant[p]);
    }
  }
  if (tables.hits.members > 0) write_hits(tables.hits, writer);
  if (!tables.overridden()) return;
  for (unsigned p = 0; p < residual_places(layout.pairs); ++p) {
    write_overrides(tables.overrides[p], writer);
  }
}

inline void read_sets(ByteReader& reader, TableChoice& tables) {
  for (unsigned p = 0; p < kPlaces; p += 2) {
    const auto both = reader.fixed<std::uint8_t>();
    tables.set[p] = both & 15;
    tables.set[p + 1] = both >> 4;
  }
}

inline void read_planes(const PlaneLayout& layout, ByteReader& reader, ChunkHead& head) {
  std::uint64_t coded = 0;
  for (unsigned p = 0; p < layout.planes; p += 8) {
    coded |= std::uint64_t{reader.fixed<std::uint8_t>()} << p;
  }
  if (coded >> layout.planes != 0) return reader.fail(Status::corrupt);
  head.coded = static_cast<std::uint32_t>(coded);
  for (unsigned p = 0; p < layout.planes; ++p) {
    if ((head.coded >> p & 1) != 0) continue;
    head.constant[p] = reader.fixed<std::uint16_t>();
    if (head.constant[p] >> (layout.plane[p].bits - 1) > 1) reader.fail(Status::corrupt);
  }
}

/// The tables that a chunk brings along.
inline void read_tables(const PlaneLayout& layout, std::uint8_t first, ByteReader& reader,
                        TableChoice& tables) {
  for (auto& o : tables.overrides) o.clear();
  tables.hits.members = 0;
  if ((first & kHasHits) != 0) {
    read_hits(reader, tables.hits);
  }
  if ((first & kHasOverrides) == 0) return;
  for (unsigned p = 0; p < residual_places(layout.pairs) && reader.ok(); ++p) {
    read_overrides(reader, tables.overrides[p]);
  }
}

/// `first` is the byte that said kModelledChunk. Tells how many bytes the tables take.
inline std::size_t read_head(const PlaneLayout& layout, bool update, std::uint8_t first,
                             ByteReader& reader, ChunkHead& head) {
  const unsigned log2_lanes = first >> 2 & 7;
  head.flat = (first & kFlat) != 0;
  head.lanes = 1U << (log2_lanes & 7);
  if (log2_lanes > 5) reader.fail(Status::corrupt);
  read_sets(reader, head.tables);
  if (layout.pairs) {
    for (auto& cap : head.cap) cap = reader.fixed<std::uint16_t>();
    head.coded = 3;
  } else {
    read_planes(layout, reader, head);
  }
  const std::size_t before = reader.rest().size();
  read_tables(layout, first, reader, head.tables);
  head.repeats = !layout.pairs && head.tables.hits.members > 0;
  if (head.repeats && (head.flat || layout.partial || layout.shared)) reader.fail(Status::corrupt);
  for (unsigned p = 0; p < kPlaces && reader.ok(); ++p) {
    if (head.tables.set[p] >= (used_place(layout, update, head, p) ? kSets : 1)) {
      reader.fail(Status::corrupt);
    }
  }
  return before - reader.rest().size();
}

}  // namespace gicodec::native
