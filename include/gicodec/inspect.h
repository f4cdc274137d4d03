// Inspects packets without decoding them, and counts the bits of payloads.
#pragma once

#include <gicodec/api.h>
#include <gicodec/packet.h>
#include <gicodec/status.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace GICODEC_API gicodec {

/// The head of a packet. All sizes are in bytes.
struct PacketInfo {
  std::uint8_t version = 0;
  PacketType type = PacketType::delta;
  std::uint8_t backend = 0;         ///< see backend_name()
  std::uint8_t texture_id = 0;      ///< chosen by the application, e.g. its place in a container
  bool lossy = false;               ///< decoded records may differ from the encoder's input
  std::uint32_t sequence = 0;       ///< number of the update; the encoder counts from 1
  std::uint32_t reference = 0;      ///< number of the update it builds on; 0 for a keyframe
  bool all_blocks = false;          ///< it has all blocks of the texture, and lists none
  std::uint32_t blocks = 0;         ///< number of blocks in the update; 0 with all_blocks
  std::size_t header_size = 0;      ///< fields and checksum
  std::size_t index_size = 0;       ///< index buffer
  std::size_t guard_band_size = 0;  ///< guard bands that do not follow the rule
  std::size_t payload_size = 0;
};

/// Reads the head of a packet, without a session. Cheap; allocates nothing; safe on hostile bytes.
/// Does not verify the checksum, and of a damaged packet `index_size` may be wrong. Errors:
/// truncated, corrupt, not_gicodec, unsupported_version, unsupported_feature.
[[nodiscard]] Result<PacketInfo> peek(std::span<const std::byte> packet) noexcept;

/// checksum_mismatch, or truncated if the packet is too short to have a checksum.
Status verify_checksum(std::span<const std::byte> packet) noexcept;

/// Where the bits of decoded payloads went, as sums. Only native counts them.
struct PayloadStatistics {
  static constexpr unsigned kPlanes = 32;
  std::uint64_t chunks = 0, raw_chunks = 0;
  std::uint32_t chunk_blocks = 0;  ///< most blocks of a chunk
  std::uint64_t head_bytes = 0;   ///< heads of payloads and chunks, with the entropy coders' states
  std::uint64_t table_bytes = 0;  ///< tables that chunks carry
  std::uint64_t raw_bytes = 0;    ///< texels of raw chunks
  std::uint64_t word_bytes = 0;   ///< the entropy coder's output: the bits below, rounded up
  double mode_bits = 0;           ///< modes of blocks
  double repeat_bits = 0;         ///< which predicted value a texel repeats, if any
  double plane_bits[kPlanes] = {};            ///< residuals by plane (docs/native.md, "Planes")
  std::uint64_t plane_symbols[kPlanes] = {};  ///< residuals coded, by plane
  std::uint64_t repeats[3] = {};   ///< texels that repeat the first value, the second, none
  std::uint64_t modes[2][8] = {};  ///< blocks by mode; pair model: by plane

  PayloadStatistics& operator+=(const PayloadStatistics& other) noexcept;
};

}  // namespace gicodec
