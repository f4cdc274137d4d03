#include "native/frame/chunk_decoder.h"

#include "native/frame/chunk_head.h"
#include "native/frame/statistics.h"
#include "native/matches/match_chunk.h"
#include "native/planes/mode_search.h"
#include "native/planes/tables.h"
#include "native/tokens/token_head.h"

#include <algorithm>
#include <cstring>

namespace gicodec::native {
namespace {

/// More than its texels that a modelled chunk may have (docs/native.md, section 4): bytes for each
/// block, and beside those.
constexpr std::size_t kMaxExtraPerBlock = 8, kMaxExtra = 80;

Status decode_raw(const Update& u, std::span<const std::uint32_t> positions,
                  std::span<const std::byte> bytes, std::span<std::byte> texels) {
  const std::size_t size = u.block_bytes(), all = u.present_bytes(positions);
  if (bytes.size() < all) return Status::truncated;
  if (bytes.size() > all) return Status::corrupt;
  for (const auto position : positions) {
    const auto block = texels.subspan(position * size, size);
    std::size_t taken = size;
    if (u.partial()) {
      taken = scatter_present(u.desc, u.presence_of(position), bytes, block);
    } else {
      std::memcpy(block.data(), bytes.data(), size);
    }
    bytes = bytes.subspan(taken);
  }
  return Status::ok;
}

/// Modes of a group's lanes; false if one is out of range or the input is short.
bool decode_modes(const Update& u, const Tables& tables, Group& group, Input& in) {
  const RoleTables& modes = *tables.role[kModePlace];
  const unsigned kinds = u.layout.mode_kinds(u.update);
  for (unsigned k = 0; k < kinds; ++k) {
    const auto context = static_cast<std::uint16_t>(mode_context(u.layout.pairs, u.update, k));
    if (!u.kernels.decode_values(modes, group.active, context, in, group.mode[k])) return false;
    for (unsigned l = 0; l < kLanes; ++l) {
      if ((group.active >> l & 1) == 0) group.mode[k][l] = 0;
      if (group.mode[k][l] >= kModes) return false;
    }
  }
  return true;
}

bool decode_group(const Update& u, std::size_t g, const Tables& tables, Input& in, Workspace& w,
                  PayloadStatistics* statistics) {
  Group group = w.group(u, g);
  if (!decode_modes(u, tables, group, in)) return false;
  load_modes(u, g, group, w);
  if (u.layout.pairs || w.head.repeats) w.load_candidates(u, g);
  if (u.layout.pairs) {
    if (!u.kernels.decode_pairs(group, tables, in)) return false;
  } else if (!u.kernels.decode_planes(group, tables, in)) {
    return false;
  }
  w.store_current(u, g, group);
  if (statistics != nullptr) count_group(u, group, tables, w, *statistics);
  return true;
}

/// What comes before the words of a modelled chunk.
Status read_modelled(const PlaneLayout& layout, bool update, std::uint8_t first, ByteReader& reader,
                     ChunkHead& head, Input& in, std::size_t& table_bytes) {
  if ((first & 3) != kModelledChunk) return Status::corrupt;
  table_bytes = read_head(layout, update, first, reader, head);
  if (!reader.ok()) return reader.status();
  for (unsigned l = 0; l < kLanes; ++l) {
    const auto state = l < head.lanes ? reader.fixed<std::uint32_t>() : kStateLow;
    if (state < kStateLow) reader.fail(Status::corrupt);
    in.high[l] = static_cast<std::uint16_t>(state >> 16);
    in.low[l] = static_cast<std::uint16_t>(state);
  }
  if (!reader.ok()) return reader.status();
  return reader.rest().size() % 2 == 0 ? Status::ok : Status::corrupt;
}

}  // namespace

Status check_chunk(const TextureDesc& desc, const PlaneLayout& layout, bool update,
                   std::span<const std::byte> bytes, ChunkHead& scratch) {
  ByteReader reader(bytes);
  const auto first = reader.fixed<std::uint8_t>();
  if (!reader.ok()) return reader.status();
  if (first == kRawChunk) {
    // The number of records that exist depends on the blocks, which are not known here.
    const std::size_t size = reader.rest().size();
    if (desc.presence != Presence::all) {
      return size % desc.record.bytes == 0 ? Status::ok : Status::corrupt;
    }
    return size != 0 && size % block_bytes(desc) == 0 ? Status::ok : Status::corrupt;
  }
  if (first == kAdaptiveChunk) return Status::ok;
  if (first == kMatchChunk) return takes_matches(desc) ? Status::ok : Status::corrupt;
  if (first == kRowChunk) return check_rows(desc, reader.rest());
  if ((first & 3) == kTokenChunk) return check_tokens(desc, first, reader.rest());
  Input in{};
  std::size_t table_bytes = 0;
  return read_modelled(layout, update, first, reader, scratch, in, table_bytes);
}

Status decode_chunk(const Update& u, std::span<const std::uint32_t> positions,
                    std::span<const std::byte> bytes, std::span<std::byte> texels, Workspace& w,
                    PayloadStatistics* statistics) {
  ByteReader reader(bytes);
  const auto first = reader.fixed<std::uint8_t>();
  if (!reader.ok()) return reader.status();
  if (statistics != nullptr) ++statistics->chunks;
  // What is behind the first byte, counted as words.
  const auto stream = [&] {
    if (statistics != nullptr) {
      ++statistics->head_bytes;
      statistics->word_bytes += bytes.size() - 1;
    }
    return reader.rest();
  };
  if (first == kRawChunk) {
    if (statistics != nullptr) {
      ++statistics->raw_chunks;
      ++statistics->head_bytes;
      statistics->raw_bytes += bytes.size() - 1;
    }
    return decode_raw(u, positions, reader.rest(), texels);
  }
  if (first == kAdaptiveChunk) {
    return decode_adaptive(u, positions, stream(), texels, w.models);
  }
  if (first == kRowChunk) {
    return decode_rows(u, positions, stream(), texels, w.rows, w.models.values);
  }
  if (first == kMatchChunk) {
    return decode_matches(u, positions, stream(), texels, w.matches);
  }
  if (!is_small_box(u.box)) return Status::corrupt;
  if ((first & 3) == kTokenChunk) {
    return decode_tokens(u, positions, first, stream(), texels, w.tokens);
  }
  ChunkHead& head = w.head;
  Input in{};
  std::size_t table_bytes = 0;
  const Status status = read_modelled(u.layout, u.update, first, reader, head, in, table_bytes);
  if (status != Status::ok) return status;
  if (!enough_lanes(head.lanes, positions.size())) return Status::corrupt;
  const std::size_t most =
      u.present_bytes(positions) + kMaxExtraPerBlock * positions.size() + kMaxExtra;
  if (bytes.size() > most) return Status::corrupt;
  if (!head.flat && !u.neighbours()) return Status::corrupt;
  const std::size_t size = reader.rest().size();
  if (statistics != nullptr) {
    statistics->table_bytes += table_bytes;
    statistics->word_bytes += size;
    statistics->head_bytes += bytes.size() - size - table_bytes;
  }
  w.bytes.resize(size + kSlack + kMaxTexelBytes);
  if (size != 0) std::memcpy(w.bytes.data(), reader.rest().data(), size);
  std::memset(w.bytes.data() + size, 0, w.bytes.size() - size);
  in.next = reinterpret_cast<const std::uint8_t*>(w.bytes.data());
  in.end = in.next + size;

  w.prepare(u, positions, head.lanes, head.flat);
  w.set_head(u);
  const Tables& set = w.adapted.apply(u.layout.pairs, u.update, head.tables);
  for (std::size_t g = 0; g < w.chunk.groups(); ++g) {
    if (u.cancelled()) return Status::cancelled;
    if (!decode_group(u, g, set, in, w, statistics)) {
      return in.next > in.end ? Status::truncated : Status::corrupt;
    }
  }
  // All lanes end where encoding began, and nothing is left.
  const bool ended =
      std::all_of(std::begin(in.high), std::end(in.high), [](auto x) { return x == 1; }) &&
      std::all_of(std::begin(in.low), std::end(in.low), [](auto x) { return x == 0; });
  if (!ended || in.next != in.end) return Status::corrupt;
  for (std::uint32_t b = 0; b < w.chunk.coded; ++b) {
    u.pack(w.current(b), texels.data() + w.chunk.blocks[b].position * u.block_bytes());
  }
  return Status::ok;
}

}  // namespace gicodec::native
