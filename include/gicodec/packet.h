// Packets: one update of one texture as bytes (FORMAT.md, "Packet").
#pragma once

#include <gicodec/api.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace GICODEC_API gicodec {

using Packet = std::vector<std::byte>;

/// What a decoder is willing to spend on bytes from outside; checked before it is spent.
struct DecodeLimits {
  std::uint64_t max_texture_bytes = std::uint64_t{1} << 30;  ///< one texture, tightly packed
  std::uint64_t max_packet_bytes = std::uint64_t{1} << 30;
  /// Memory of a decoder, or of a client with all it holds, at its worst (docs/guarantees.md).
  std::uint64_t max_total_bytes = std::uint64_t{4} << 30;
  /// Work: bytes of blocks that one packet, or one message of a server, may write or clear.
  std::uint64_t max_work_bytes = std::uint64_t{2} << 30;
  std::uint32_t max_textures = 256;  ///< in one container
  std::uint64_t max_description_bytes = std::uint64_t{1} << 20;
  std::uint64_t max_index_bytes = std::uint64_t{64} << 20;  ///< seek index of a container
};

}  // namespace gicodec
