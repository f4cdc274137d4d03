// Packets: one update of one texture as bytes (FORMAT.md, "Packet").
#pragma once

#include <gicodec/status.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

using Packet = std::vector<std::byte>;

/// What the head of a packet says. All sizes in bytes.
struct PacketInfo {
  std::uint8_t version = 0;
  std::uint8_t backend = 0;     ///< see backend_name()
  std::uint8_t texture_id = 0;  ///< chosen by the application, e.g. its place in a container
  bool keyframe = false;        ///< needs no mirror; probes not listed become zero
  bool snapshot = false;        ///< a keyframe that stands for the update of the same sequence
  bool skip = false;            ///< an update that stands for all since its reference
  bool fresh = false;           ///< an update that does not read what its probes held before
  bool lossy = false;           ///< decoded texels may differ from the encoder's input
  std::uint32_t sequence = 0;   ///< number of the update, counted from 1 by the encoder
  std::uint32_t reference = 0;  ///< the update this one builds on; 0 for a keyframe
  bool all_probes = false;      ///< every probe of the grid, whose number the packet does not say
  std::uint32_t probes = 0;     ///< number of probes in the update; 0 with all_probes
  std::size_t header_size = 0;  ///< fields, checksum included
  std::size_t index_size = 0;   ///< probe index buffer
  std::size_t border_size = 0;  ///< guard bands that do not follow the rule
  std::size_t payload_size = 0;
};

/// Reads the head of a packet without a session: cheap, allocates nothing, safe on any bytes.
/// Does not verify the checksum. The index buffer's size is only known for a sound packet.
[[nodiscard]] Result<PacketInfo> peek(std::span<const std::byte> packet) noexcept;

/// Verifies the checksum of a packet.
Status verify_checksum(std::span<const std::byte> packet) noexcept;

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
