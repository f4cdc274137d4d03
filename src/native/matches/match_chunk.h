// Match chunks: bytes that came before in the chunk, however far (docs/native/matches.md).
#pragma once

#include "native/matches/match_memory.h"

#include <gicodec/backend.h>
#include <gicodec/status.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::native {

struct Update;

inline constexpr std::uint8_t kMatchChunk = 10;

/// Whether every record exists.
[[nodiscard]] bool takes_matches(const TextureDesc& desc) noexcept;

/// Appends a match chunk unless it would have more than `most` bytes; false then. Takes the order
/// of bytes that a quick look finds best. `thorough`: takes time to find matches.
bool encode_matches(const Update& u, std::span<const std::uint32_t> positions,
                    const BlockTable& texels, std::size_t most, bool thorough, MatchMemory& memory,
                    std::vector<std::byte>& out);
Status decode_matches(const Update& u, std::span<const std::uint32_t> positions,
                      std::span<const std::byte> bytes, std::span<std::byte> texels,
                      MatchMemory& memory);

}  // namespace gicodec::native
