// Index buffers (Stengel et al. §3.4): which blocks an update holds, delta-coded. The encoder
// takes the smallest of four modes, so that the buffer never exceeds one bit per block.
#pragma once

#include <gicodec/status.h>

#include "base/memory.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

enum class IndexMode : std::uint8_t {
  all = 0,     ///< every block; no bytes
  bitmap = 1,  ///< one bit per block
  gaps = 2,    ///< Rice-coded distances between successive blocks
  runs = 3,    ///< lengths of the gaps and runs in turn, by a coder that learns
};

[[nodiscard]] constexpr std::size_t index_buffer_bound(std::uint32_t block_count) noexcept {
  return (std::size_t{block_count} + 7) / 8;
}

/// Appends the buffer to `out` and returns its mode. Precondition: `blocks` is ascending without
/// repeats and each is below block_count.
IndexMode encode_index_buffer(std::span<const std::uint32_t> blocks, std::uint32_t block_count,
                              std::vector<std::byte>& out);

/// Whether these bytes are the buffer of `count` indices: ok or corrupt, after time in proportion
/// to the bytes, however many indices they stand for.
Status check_index_buffer(IndexMode mode, std::uint32_t count, std::uint32_t block_count,
                          std::span<const std::byte> bytes) noexcept;
/// Replaces `blocks` by the `count` indices of exactly these bytes, ascending and below
/// block_count. Status::corrupt otherwise, and nothing is allocated.
Status decode_index_buffer(IndexMode mode, std::uint32_t count, std::uint32_t block_count,
                           std::span<const std::byte> bytes, Vector<std::uint32_t>& blocks);

}  // namespace gicodec
