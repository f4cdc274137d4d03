// Index buffers (Stengel et al. §3.4): the delta-coded indices of an update's blocks. The encoder
// takes the smallest of four modes, so a buffer never exceeds a bit per block of the texture.
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
  runs = 3,    ///< lengths of gaps and runs in turn, by an adaptive coder
};

[[nodiscard]] constexpr std::size_t index_buffer_bound(std::uint32_t block_count) noexcept {
  return (std::size_t{block_count} + 7) / 8;
}

/// Appends the buffer to `out` and returns its mode. Precondition: `blocks` is ascending, unique
/// and below block_count.
IndexMode encode_index_buffer(std::span<const std::uint32_t> blocks, std::uint32_t block_count,
                              std::vector<std::byte>& out);

/// ok if these bytes are a buffer of `count` indices, else corrupt. Takes time in proportion to the
/// bytes, not to `count`; allocates nothing.
Status check_index_buffer(IndexMode mode, std::uint32_t count, std::uint32_t block_count,
                          std::span<const std::byte> bytes) noexcept;
/// Replaces `blocks` by the `count` indices of these bytes, ascending and below block_count.
/// corrupt otherwise; then it allocates nothing.
Status decode_index_buffer(IndexMode mode, std::uint32_t count, std::uint32_t block_count,
                           std::span<const std::byte> bytes, Vector<std::uint32_t>& blocks);

}  // namespace gicodec
