// Packet layout (FORMAT.md, "Packet"): head, index buffer, guard band section, payload, checksum.
#pragma once

#include <gicodec/inspect.h>
#include <gicodec/packet.h>
#include <gicodec/texture.h>

#include "bitstream/index_buffer.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

/// The parts of a packet; spans refer to its bytes.
struct PacketParts {
  PacketInfo info;
  IndexMode index_mode = IndexMode::all;
  std::uint32_t base = 0;        ///< as in PacketHead
  std::uint32_t stands_for = 0;  ///< as in PacketHead
  std::span<const std::byte> index;
  std::span<const std::byte> guard_bands;
  std::span<const std::byte> payload;
};

/// What write_packet_head() needs besides the sections. It ignores sizes in `info`.
struct PacketHead {
  PacketInfo info;
  IndexMode index_mode = IndexMode::all;
  /// Identifies what the packet builds on: for a keyframe the texture description's hash, else the
  /// checksum of packet `reference`. Sequence numbers alone could match another session's state.
  std::uint32_t base = 0;
  /// Of a stand-in: the checksum of the packet with the same sequence that it replaces.
  std::uint32_t stands_for = 0;
};

/// The end of a chain of packets.
struct PacketChain {
  std::uint8_t backend = 0;
  std::uint8_t texture_id = 0;
  std::uint32_t sequence = 0;  ///< of the last packet; 0 before the first
  std::uint32_t checksum = 0;  ///< of the last packet

  /// The head of the next packet; `description` is the texture's description_hash(). Precondition:
  /// sequence < UINT32_MAX.
  [[nodiscard]] PacketHead next(std::uint32_t description, PacketType type) const;
  /// The head of a stand-in for all packets from here to `later`, a later point of the same chain.
  /// `type`: keyframe, delta or intra. Precondition: `later` has a packet and, unless `type` is
  /// keyframe, is behind this one.
  [[nodiscard]] PacketHead stand_in(std::uint32_t description, PacketType type,
                                    const PacketChain& later) const;
};

inline constexpr std::size_t kMaxPacketHead =
    4 + 5 + 5 + 4 + 4 + 5 + 10 + 10;  // each field at its longest
inline constexpr std::size_t kPacketChecksum = 4;

/// Appends head, index buffer and guard bands; the payload and seal_packet() follow.
void write_packet_head(const PacketHead& head, std::span<const std::byte> index,
                       std::span<const std::byte> guard_bands, std::vector<std::byte>& out);
/// Appends the checksum of everything in `packet`, and returns it.
std::uint32_t seal_packet(std::vector<std::byte>& packet);
/// The checksum field of a packet. Precondition: parse_packet() accepts the packet.
[[nodiscard]] std::uint32_t packet_checksum(std::span<const std::byte> packet) noexcept;

/// The checksum that identifies the state after a packet: its own, or `stands_for` of a stand-in.
[[nodiscard]] std::uint32_t checksum_after(const PacketParts& parts,
                                           std::span<const std::byte> packet) noexcept;

/// Splits a packet into parts and checks all fields of the head. Does not verify the checksum.
[[nodiscard]] Result<PacketParts> parse_packet(std::span<const std::byte> packet) noexcept;

}  // namespace gicodec
