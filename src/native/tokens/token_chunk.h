// Token chunks: a byte says what a texel is, and prefix codes its bits; fast rather than small
// (docs/native/tokens.md).
#pragma once

#include "base/memory.h"
#include "native/tokens/token_kernels.h"

#include <gicodec/backend.h>
#include <gicodec/status.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::native {

struct Update;

/// Memory of one thread, kept for its capacity.
struct TokenMemory {
  CodeWriter writer;
  CodeReader reader;
  Vector<std::uint16_t> values;  ///< planes of blocks, one after the other
  Vector<std::uint16_t> columns, scratch;
  Vector<std::size_t> held;          ///< places of the blocks whose planes are kept
  Vector<std::int32_t> slots;        ///< of every place of the box: the block of the chunk
  Vector<std::uint8_t> tokens;       ///< of all groups
  Vector<std::uint8_t> unit_tokens;  ///< of a block
  std::array<Vector<std::uint8_t>, kMaxGroups> map;  ///< of units that are coded
  Vector<std::uint8_t> raw, streams;
};

/// Whether blocks of the texture can be tokens: all records exist.
[[nodiscard]] bool takes_tokens(const TextureDesc& desc) noexcept;

/// Appends the chunk unless it would have more than `most` bytes; false then, and `out` is as it
/// was.
bool encode_tokens(const Update& u, std::span<const std::uint32_t> positions,
                   const BlockTable& records, unsigned streams, std::size_t most,
                   TokenMemory& memory, std::vector<std::byte>& out);
/// Checks a chunk's head, tables and sizes. `first`: its first byte, `bytes`: what follows.
Status check_tokens(const TextureDesc& desc, std::uint8_t first, std::span<const std::byte> bytes);
/// Safe on any bytes.
Status decode_tokens(const Update& u, std::span<const std::uint32_t> positions, std::uint8_t first,
                     std::span<const std::byte> bytes, std::span<std::byte> records,
                     TokenMemory& memory);

}  // namespace gicodec::native
