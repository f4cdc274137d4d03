#include "native/tokens/token_blocks.h"
#include "native/tokens/token_head.h"

#include <algorithm>
#include <bit>

namespace gicodec::native {
namespace {

/// A stream's tokens have room behind them.
std::size_t tokens_at(std::size_t block, std::size_t texels, unsigned stream) {
  return block * texels + stream * kTokenSlack;
}

/// Reads all streams of a group.
bool read_streams(const GroupParts& parts, unsigned streams, std::size_t blocks, std::size_t texels,
                  std::span<std::uint8_t> tokens, const CodeReader& reader) {
  for (unsigned s = 0; s < streams; s += kStreamsAtOnce) {
    std::array<TokenStream, kStreamsAtOnce> some{};
    for (unsigned k = 0; k < kStreamsAtOnce; ++k) {
      const std::size_t first = first_block(blocks, s + k, streams),
                        last = first_block(blocks, s + k + 1, streams);
      some[k] = {parts.stream[s + k],
                 tokens.subspan(tokens_at(first, texels, s + k), (last - first) * texels)};
    }
    if (!reader.read(some)) return false;
  }
  return true;
}

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
  TokenBlocks blocks(u, positions, head.refers, layout.pairs, memory);
  TokenGroups groups = token_groups(layout, head.coded);
  const std::size_t n = positions.size(), texels = blocks.texels();
  const std::size_t all = n * texels + head.streams * kTokenSlack;
  memory.tokens.resize(groups.count * all + kTokenSlack);
  memory.raw.clear();
  std::array<BitSource, kMaxGroups> source{};
  std::array<std::size_t, kMaxGroups> raw_at{};
  std::array<std::uint64_t, kMaxGroups> raw_bits{};
  for (unsigned g = 0; g < groups.count; ++g) {
    GroupParts parts;
    read_group(groups.group[g], head.streams, reader, parts);
    memory.reader.set(parts.lengths, groups.group[g].tokens());
    const auto tokens = std::span(memory.tokens).subspan(g * all, all);
    if (!read_streams(parts, head.streams, n, texels, tokens, memory.reader))
      return Status::corrupt;
    raw_at[g] = memory.raw.size();
    raw_bits[g] = std::uint64_t{8} * parts.raw.size();
    // What a block may read beyond the end.
    const auto* const raw = reinterpret_cast<const std::uint8_t*>(parts.raw.data());
    memory.raw.insert(memory.raw.end(), raw, raw + parts.raw.size());
    memory.raw.resize(memory.raw.size() + texels * kMaxRawBytes + kRawSlack);
  }
  for (unsigned g = 0; g < groups.count; ++g) source[g].bytes = memory.raw.data() + raw_at[g];
  for (unsigned p = 0; p < layout.planes; ++p) {
    if ((head.coded >> p & 1) == 0) std::fill_n(blocks.plane(p), texels, head.constant[p]);
  }
  const BlockTable known{records.data(), u.block_bytes()};
  unsigned stream = 0;
  for (std::size_t b = 0; b < n; ++b) {
    if (u.cancelled()) return Status::cancelled;
    while (b >= first_block(n, stream + 1, head.streams)) ++stream;
    blocks.load(b, known, false);
    for (unsigned g = 0; g < groups.count; ++g) {
      const TokenGroup& group = groups.group[g];
      std::array<std::uint16_t*, kMaxGroupPlanes> planes{};
      for (unsigned i = 0; i < group.planes; ++i) planes[i] = blocks.plane(group.plane[i]);
      u.tokens.read(group, blocks.block(group),
                    &memory.tokens[g * all + tokens_at(b, texels, stream)], source[g],
                    planes.data());
      if (source[g].at > raw_bits[g]) return Status::truncated;
    }
    blocks.store(records.data() + positions[b] * u.block_bytes());
  }
  for (unsigned g = 0; g < groups.count; ++g) {
    const std::uint64_t left = raw_bits[g] - source[g].at;
    if (left >= 8) return Status::corrupt;
    const auto last = static_cast<std::size_t>(source[g].at / 8);
    if (left > 0 && source[g].bytes[last] >> (8 - left) != 0) return Status::corrupt;
  }
  return Status::ok;
}

}  // namespace gicodec::native
