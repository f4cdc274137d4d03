#include "native/tokens/token_blocks.h"
#include "native/tokens/token_head.h"
#include "native/tokens/token_units.h"

#include <algorithm>
#include <bit>

namespace gicodec::native {
namespace {

/// A stream's tokens have room behind them.
std::size_t tokens_at(std::size_t block, std::size_t texels, unsigned stream) {
  return block * texels + stream * kTokenSlack;
}

/// Reads all streams of a group. `units`: of a sparse one, else null.
bool read_streams(const GroupParts& parts, unsigned streams, std::size_t blocks, std::size_t texels,
                  const TokenUnits* units, std::span<std::uint8_t> tokens,
                  const CodeReader& reader) {
  for (unsigned s = 0; s < streams; s += kStreamsAtOnce) {
    std::array<TokenStream, kStreamsAtOnce> some{};
    for (unsigned k = 0; k < kStreamsAtOnce; ++k) {
      const std::size_t first = first_block(blocks, s + k, streams),
                        last = first_block(blocks, s + k + 1, streams);
      some[k] = {parts.stream[s + k], tokens.subspan(tokens_at(first, texels, s + k),
                                                     units != nullptr ? units->coded(first, last)
                                                                      : (last - first) * texels)};
    }
    if (!reader.read(some)) return false;
  }
  return true;
}

/// Where a group's tokens and raw bits are read.
struct GroupSource {
  std::uint8_t* tokens = nullptr;
  const std::uint8_t* next = nullptr;  ///< of the next block
  std::size_t raw_at = 0;
  std::uint64_t raw_bits = 0;
  BitSource raw{};

  /// Whether all raw bits were read, but for zeros in the last byte.
  [[nodiscard]] bool ends() const {
    const std::uint64_t left = raw_bits - raw.at;
    const auto last = static_cast<std::size_t>(raw.at / 8);
    return left < 8 && (left == 0 || raw.bytes[last] >> (8 - left) == 0);
  }
};

}  // namespace

Status check_tokens(const TextureDesc& desc, std::uint8_t first, std::span<const std::byte> bytes) {
  if (!takes_tokens(desc)) return Status::corrupt;
  const PlaneLayout layout = plane_layout(desc);
  ByteReader reader(bytes);
  const TokenHead head = read_token_head(layout, first, reader);
  if (!reader.ok()) return reader.status();
  if (layout.pairs && head.coded != 3) return Status::corrupt;
  TokenGroups groups = token_groups(layout, head.coded);
  GroupParts parts;
  for (unsigned g = 0; g < groups.count && reader.ok(); ++g) {
    read_group(groups.group[g], head.streams, reader, parts);
  }
  if (!reader.ok()) return reader.status();
  return reader.rest().empty() ? Status::ok : Status::corrupt;
}

Status decode_tokens(const Update& u, std::span<const std::uint32_t> positions, std::uint8_t first,
                     std::span<const std::byte> bytes, std::span<std::byte> records,
                     TokenMemory& memory) {
  if (const Status status = check_tokens(u.desc, first, bytes); status != Status::ok) return status;
  ByteReader reader(bytes);
  const PlaneLayout layout = plane_layout(u.desc);
  const TokenHead head = read_token_head(layout, first, reader);
  if (head.refers && u.update) return Status::corrupt;
  TokenBlocks blocks(u, positions, head, memory);
  TokenGroups groups = token_groups(layout, head.coded);
  const std::size_t n = positions.size(), texels = blocks.texels();
  const std::size_t all = n * texels + head.streams * kTokenSlack;
  memory.tokens.resize(groups.count * all + kTokenSlack);
  memory.unit_tokens.resize(texels + kUnit + kTokenSlack);
  memory.raw.clear();
  std::array<GroupSource, kMaxGroups> sources{};
  for (unsigned g = 0; g < groups.count; ++g) {
    GroupParts parts;
    read_group(groups.group[g], head.streams, reader, parts);
    memory.reader.set(parts.lengths, groups.group[g].tokens());
    TokenUnits units(n, texels, memory.map[g]);
    const bool sparse = groups.group[g].sparse;
    if (sparse && !units.read(parts.map)) return Status::corrupt;
    sources[g].tokens = memory.tokens.data() + g * all;
    if (!read_streams(parts, head.streams, n, texels, sparse ? &units : nullptr,
                      {sources[g].tokens, all}, memory.reader)) {
      return Status::corrupt;
    }
    sources[g].raw_at = memory.raw.size();
    sources[g].raw_bits = std::uint64_t{8} * parts.raw.size();
    // What a block may read beyond the end.
    const auto* const raw = reinterpret_cast<const std::uint8_t*>(parts.raw.data());
    memory.raw.insert(memory.raw.end(), raw, raw + parts.raw.size());
    memory.raw.resize(memory.raw.size() + texels * kMaxRawBytes + kRawSlack);
  }
  for (unsigned g = 0; g < groups.count; ++g)
    sources[g].raw.bytes = memory.raw.data() + sources[g].raw_at;
  for (unsigned p = 0; p < layout.planes; ++p) {
    if ((head.coded >> p & 1) == 0) blocks.fill(p, head.constant[p]);
  }
  const BlockTable known{records.data(), u.block_bytes()};
  for (unsigned s = 0; s < head.streams; ++s) {
    const std::size_t begin = first_block(n, s, head.streams),
                      end = first_block(n, s + 1, head.streams);
    for (unsigned g = 0; g < groups.count; ++g)
      sources[g].next = sources[g].tokens + tokens_at(begin, texels, s);
    for (std::size_t b = begin; b < end; ++b) {
      if (u.cancelled()) return Status::cancelled;
      blocks.load(b, known, false);
      for (unsigned g = 0; g < groups.count; ++g) {
        const TokenGroup& group = groups.group[g];
        GroupSource& source = sources[g];
        std::array<std::uint16_t*, kMaxGroupPlanes> planes{};
        for (unsigned i = 0; i < group.planes; ++i) planes[i] = blocks.plane(group.plane[i]);
        const std::uint8_t* tokens = source.next;
        if (group.sparse) {
          tokens = memory.unit_tokens.data();
          source.next = TokenUnits(n, texels, memory.map[g])
                            .scatter(b, source.next, memory.unit_tokens.data());
        } else {
          source.next += texels;
        }
        u.tokens.read(group, blocks.block(group), tokens, source.raw, planes.data());
        if (source.raw.at > source.raw_bits) return Status::truncated;
      }
      blocks.store(records.data() + positions[b] * u.block_bytes());
    }
  }
  for (unsigned g = 0; g < groups.count; ++g) {
    if (!sources[g].ends()) return Status::corrupt;
  }
  return Status::ok;
}

}  // namespace gicodec::native
