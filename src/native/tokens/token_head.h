// The head of a token chunk as bytes (docs/native/tokens.md, "Chunk").
#pragma once

#include "base/bytes.h"
#include "native/planes/coded_planes.h"
#include "native/tokens/token_groups.h"

#include <array>
#include <bit>
#include <vector>

namespace gicodec::native {

inline constexpr std::uint8_t kTokenChunk = 3;
inline constexpr std::uint8_t kRefers = 0x04, kContinues = 0x40;
inline constexpr std::uint8_t kFollows = 0x04, kSparse = 0x08;  // of a group
inline constexpr unsigned kStreamsShift = 3, kStreamsBits = 3;

struct TokenHead {
  bool refers = false;     ///< blocks refer to neighbours
  bool continues = false;  ///< rows continue those of the block above
  unsigned streams = kStreamsAtOnce;
  std::uint32_t coded = 0;
  std::array<std::uint16_t, kMaxPlanes> constant{};
};

/// The block that a stream begins with; for `streams`, the number of blocks.
inline std::size_t first_block(std::size_t blocks, unsigned stream, unsigned streams) {
  return blocks * stream / streams;
}

/// What a group's head says, and its bytes.
struct GroupParts {
  CodeLengths lengths{};
  std::span<const std::byte> map;  ///< of sparse groups
  std::array<std::span<const std::byte>, kMaxStreams> stream;
  std::span<const std::byte> raw;
};

inline void write_token_head(const PlaneLayout& layout, const TokenHead& head, ByteWriter& writer) {
  const int streams = std::countr_zero(head.streams / kStreamsAtOnce);
  writer.fixed(static_cast<std::uint8_t>(kTokenChunk | (head.refers ? kRefers : 0) |
                                         (head.continues ? kContinues : 0) |
                                         streams << kStreamsShift));
  write_coded(layout, head.coded, head.constant, writer);
}

inline TokenHead read_token_head(const PlaneLayout& layout, std::uint8_t first,
                                 ByteReader& reader) {
  TokenHead head;
  head.refers = (first & kRefers) != 0;
  head.continues = (first & kContinues) != 0;
  head.streams = kStreamsAtOnce << (first >> kStreamsShift & ((1U << kStreamsBits) - 1));
  if (first >= 2 * kContinues || (head.refers && head.continues) || head.streams > kMaxStreams)
    reader.fail(Status::corrupt);
  head.coded = read_coded(layout, reader, head.constant);
  return head;
}

inline void write_lengths(const CodeLengths& lengths, unsigned tokens, ByteWriter& writer) {
  for (unsigned t = 0; t < tokens; t += 2) {
    const unsigned second = t + 1 < tokens ? lengths[t + 1] : 0U;
    writer.fixed(static_cast<std::uint8_t>(lengths[t] | second << 4));
  }
}

/// The rest of a group: its prediction goes into `group`.
inline void read_group(TokenGroup& group, unsigned streams, ByteReader& reader, GroupParts& parts) {
  const auto first = reader.fixed<std::uint8_t>();
  group.prediction = static_cast<TokenPrediction>(first & 3);
  group.follows = (first & kFollows) != 0;
  group.sparse = (first & kSparse) != 0;
  const bool copies = group.copies != 0;
  const unsigned predictions = copies ? kCopyingPredictions : kTokenPredictions;
  if (first >= 2 * kSparse || (first & 3) >= predictions ||
      (group.follows && !group.can_follow())) {
    reader.fail(Status::corrupt);
  }
  const unsigned tokens = group.tokens();
  for (unsigned t = 0; t < tokens; t += 2) {
    const auto both = reader.fixed<std::uint8_t>();
    parts.lengths[t] = both & 15;
    if (t + 1 < tokens) parts.lengths[t + 1] = both >> 4;
    if (t + 1 == tokens && both > 15) reader.fail(Status::corrupt);
  }
  if (reader.ok() && !is_complete(parts.lengths, tokens)) reader.fail(Status::corrupt);
  if (group.sparse) parts.map = reader.bytes(static_cast<std::size_t>(reader.varint(UINT32_MAX)));
  std::array<std::size_t, kMaxStreams + 1> sizes{};
  for (unsigned s = 0; s <= streams; ++s) {
    sizes[s] = static_cast<std::size_t>(reader.varint(UINT32_MAX));
  }
  for (unsigned s = 0; s < streams; ++s) parts.stream[s] = reader.bytes(sizes[s]);
  parts.raw = reader.bytes(sizes[streams]);
}

}  // namespace gicodec::native
