// Head of a chunk as bytes (docs/native.md, "Chunk").
#pragma once

#include "base/bytes.h"
#include "native/frame/workspace.h"
#include "native/planes/coded_planes.h"

#include <bit>
#include <vector>

namespace gicodec::native {

inline constexpr std::uint8_t kRawChunk = 0;
inline constexpr std::uint8_t kModelledChunk = 1;
inline constexpr std::uint8_t kAdaptiveChunk = 2;

inline constexpr std::uint8_t kHasOverrides = 0x20;
inline constexpr std::uint8_t kFlat = 0x40;
inline constexpr std::uint8_t kHasRepeats = 0x80;

/// Whether a chunk has symbols in that place that a static set is for.
inline bool used_place(const PlaneLayout& layout, bool update, const ChunkHead& head,
                       unsigned place) {
  if (place == kModePlace) return !layout.pairs || update;
  if (layout.pairs) return place != kRepeatPlace || head.tables.repeats.distributions == 0;
  for (unsigned p = 0; p < layout.planes; ++p) {
    if ((head.coded >> p & 1) != 0 && place_of(p, layout.low) == place) return true;
  }
  return false;
}

inline void write_distribution(const Distribution& m, ByteWriter& writer) {
  const unsigned n = listed_symbols(m);
  writer.fixed(static_cast<std::uint16_t>(m.shift | m.unit << 3 | n << 6));
  for (unsigned s = 0; s < n; ++s) writer.fixed(m.units[s]);
  writer.fixed(m.units[kEscape]);
}
inline void read_distribution(ByteReader& reader, Distribution& m) {
  const auto fields = reader.fixed<std::uint16_t>();
  const unsigned n = fields >> 6;
  m = {static_cast<std::uint8_t>(fields >> 3 & 7), static_cast<std::uint8_t>(fields & 7), {}};
  if (n > kEscape) return reader.fail(Status::corrupt);
  for (unsigned s = 0; s < n; ++s) m.units[s] = reader.fixed<std::uint8_t>();
  m.units[kEscape] = reader.fixed<std::uint8_t>();
  if (reader.ok() && !valid(m)) reader.fail(Status::corrupt);
}

inline void write_overrides(const Overrides& overrides, ByteWriter& writer) {
  writer.fixed(static_cast<std::uint8_t>(overrides.distributions.size()));
  for (const auto& r : overrides.distributions) {
    writer.fixed(r.number);
    write_distribution(r.distribution, writer);
  }
  writer.fixed(static_cast<std::uint16_t>(overrides.contexts.size()));
  for (const auto& m : overrides.contexts) {
    writer.fixed(m.context);
    writer.fixed(m.distribution);
  }
}
inline void read_overrides(ByteReader& reader, Overrides& overrides) {
  const unsigned distributions = reader.fixed<std::uint8_t>();
  if (distributions > kDistributions) return reader.fail(Status::corrupt);
  unsigned next = 0;
  for (unsigned i = 0; i < distributions && reader.ok(); ++i) {
    Overrides::Replaced r{reader.fixed<std::uint8_t>(), {}};
    if (r.number < next || r.number >= kDistributions) return reader.fail(Status::corrupt);
    read_distribution(reader, r.distribution);
    overrides.distributions.push_back(r);
    next = r.number + 1U;
  }
  const unsigned contexts = reader.fixed<std::uint16_t>();
  if (contexts > kContexts) return reader.fail(Status::corrupt);
  next = 0;
  for (unsigned i = 0; i < contexts && reader.ok(); ++i) {
    const auto context = reader.fixed<std::uint8_t>();
    const auto distribution = reader.fixed<std::uint8_t>();
    if (context < next || distribution >= kDistributions) return reader.fail(Status::corrupt);
    overrides.contexts.push_back({context, distribution});
    next = context + 1U;
  }
}

inline void write_repeat_tables(const OwnRepeats& repeats, ByteWriter& writer) {
  writer.fixed(static_cast<std::uint8_t>(repeats.distributions));
  for (unsigned m = 0; m < repeats.distributions; ++m) {
    for (const auto end : repeats.end[m]) writer.fixed(end);
  }
  for (unsigned c = 0; c < kRepeatContexts; c += 2) {
    writer.fixed(static_cast<std::uint8_t>(repeats.map[c] | repeats.map[c + 1] << 4));
  }
}
inline void read_repeat_tables(ByteReader& reader, OwnRepeats& repeats) {
  repeats.distributions = reader.fixed<std::uint8_t>();
  if (repeats.distributions < 1 || repeats.distributions > kDistributions)
    return reader.fail(Status::corrupt);
  for (unsigned m = 0; m < repeats.distributions; ++m) {
    for (auto& end : repeats.end[m]) end = reader.fixed<std::uint16_t>();
    const auto& [end0, end1] = repeats.end[m];
    if (end0 == 0 || end0 >= end1 || end1 >= kProbabilityScale) {
      return reader.fail(Status::corrupt);
    }
  }
  for (unsigned c = 0; c < kRepeatContexts; c += 2) {
    const auto both = reader.fixed<std::uint8_t>();
    repeats.map[c] = both & 15;
    repeats.map[c + 1] = both >> 4;
    if (repeats.map[c] >= repeats.distributions || repeats.map[c + 1] >= repeats.distributions) {
      return reader.fail(Status::corrupt);
    }
  }
}

inline void write_head(const PlaneLayout& layout, const ChunkHead& head,
                       std::vector<std::byte>& out) {
  const TableChoice& tables = head.tables;
  ByteWriter writer(out);
  writer.fixed(static_cast<std::uint8_t>(kModelledChunk | std::countr_zero(head.lanes) << 2 |
                                         (head.flat ? kFlat : 0) |
                                         (tables.overridden() ? kHasOverrides : 0) |
                                         (tables.repeats.distributions > 0 ? kHasRepeats : 0)));
  for (unsigned p = 0; p < kPlaces; p += 2) {
    writer.fixed(static_cast<std::uint8_t>(tables.set[p] | tables.set[p + 1] << 4));
  }
  if (layout.pairs) {
    for (const auto frequent : head.frequent) writer.fixed(frequent);
  } else {
    write_coded(layout, head.coded, head.constant, writer);
  }
  if (tables.repeats.distributions > 0) write_repeat_tables(tables.repeats, writer);
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

/// The tables that a chunk carries.
inline void read_tables(const PlaneLayout& layout, std::uint8_t first, ByteReader& reader,
                        TableChoice& tables) {
  for (auto& o : tables.overrides) o.clear();
  tables.repeats.distributions = 0;
  if ((first & kHasRepeats) != 0) {
    read_repeat_tables(reader, tables.repeats);
  }
  if ((first & kHasOverrides) == 0) return;
  for (unsigned p = 0; p < residual_places(layout.pairs) && reader.ok(); ++p) {
    read_overrides(reader, tables.overrides[p]);
  }
}

/// `first` is the chunk's first byte, of kModelledChunk. Returns how many bytes the tables take.
inline std::size_t read_head(const PlaneLayout& layout, bool update, std::uint8_t first,
                             ByteReader& reader, ChunkHead& head) {
  const unsigned log2_lanes = first >> 2 & 7;
  head.flat = (first & kFlat) != 0;
  head.lanes = 1U << (log2_lanes & 7);
  if (log2_lanes > 5) reader.fail(Status::corrupt);
  read_sets(reader, head.tables);
  if (layout.pairs) {
    for (auto& frequent : head.frequent) frequent = reader.fixed<std::uint16_t>();
    head.coded = 3;
  } else {
    head.coded = read_coded(layout, reader, head.constant);
  }
  const std::size_t before = reader.rest().size();
  read_tables(layout, first, reader, head.tables);
  head.repeats = !layout.pairs && head.tables.repeats.distributions > 0;
  if (head.repeats && (head.flat || layout.partial || layout.shared)) reader.fail(Status::corrupt);
  for (unsigned p = 0; p < kPlaces && reader.ok(); ++p) {
    if (head.tables.set[p] >= (used_place(layout, update, head, p) ? kSets : 1)) {
      reader.fail(Status::corrupt);
    }
  }
  return before - reader.rest().size();
}

}  // namespace gicodec::native
