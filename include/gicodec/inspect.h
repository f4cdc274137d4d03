// What can be told of a packet without decoding it, and where the bits of payloads went.
#pragma once

#include <gicodec/api.h>
#include <gicodec/packet.h>
#include <gicodec/status.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace GICODEC_API gicodec {

/// What the head of a packet says. All sizes in bytes.
struct PacketInfo {
  std::uint8_t version = 0;
  PacketType type = PacketType::delta;
  std::uint8_t backend = 0;         ///< see backend_name()
  std::uint8_t texture_id = 0;      ///< chosen by the application, e.g. its place in a container
  bool lossy = false;               ///< decoded records may differ from the encoder's input
  std::uint32_t sequence = 0;       ///< number of the update, counted from 1 by the encoder
  std::uint32_t reference = 0;      ///< the update this one builds on; 0 for a keyframe
  bool all_blocks = false;          ///< every block, whose number the packet does not say
  std::uint32_t blocks = 0;         ///< number of blocks in the update; 0 with all_blocks
  std::size_t header_size = 0;      ///< fields, checksum included
  std::size_t index_size = 0;       ///< index buffer
  std::size_t guard_band_size = 0;  ///< guard bands that do not follow the rule
  std::size_t payload_size = 0;
};

/// Reads the head of a packet without a session: cheap, allocates nothing, safe on any bytes.
/// Does not verify the checksum. The index buffer's size is only known for a sound packet.
[[nodiscard]] Result<PacketInfo> peek(std::span<const std::byte> packet) noexcept;

/// Verifies the checksum of a packet.
Status verify_checksum(std::span<const std::byte> packet) noexcept;

/// Where the bits of decoded payloads went, in sums. Only "native" tells.
struct PayloadStatistics {
  static constexpr unsigned kPlanes = 32;
  std::uint64_t chunks = 0, raw_chunks = 0;
  std::uint32_t chunk_blocks = 0;   ///< blocks of a chunk at most
  std::uint64_t head_bytes = 0;     ///< of payloads and chunks, entropy coder states included
  std::uint64_t table_bytes = 0;    ///< tables that chunks bring along
  std::uint64_t raw_bytes = 0;      ///< texels of raw chunks
  std::uint64_t word_bytes = 0;     ///< what the entropy coder wrote; the bits below, rounded up
  double mode_bits = 0;             ///< choice of modes
  double repeat_bits = 0;           ///< which candidate a texel repeats, if any
  double plane_bits[kPlanes] = {};  ///< residuals by plane (docs/native.md, "Planes")
  std::uint64_t plane_symbols[kPlanes] = {};  ///< residuals coded
  std::uint64_t repeats[3] = {};              ///< first guess, second guess, escape
  std::uint64_t modes[2][8] = {};             ///< blocks by mode, of the pair model by plane

  PayloadStatistics& operator+=(const PayloadStatistics& other) noexcept;
};

}  // namespace gicodec
