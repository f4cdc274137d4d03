// Packet layout (FORMAT.md, "Packet"): head, index buffer, guard bands, payload, checksum.
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

/// A packet taken apart; the spans refer to its bytes.
struct PacketParts {
  PacketInfo info;
  IndexMode index_mode = IndexMode::all;
  std::uint32_t base = 0;        ///< as in PacketHead
  std::uint32_t stands_for = 0;  ///< as in PacketHead
  std::span<const std::byte> index;
  std::span<const std::byte> guard_bands;
  std::span<const std::byte> payload;
};

/// Fields that the writer needs besides the sections; sizes in `info` are not read.
struct PacketHead {
  PacketInfo info;
  IndexMode index_mode = IndexMode::all;
  /// What the packet builds on: the texture description's hash for a keyframe, the checksum of the
  /// referenced packet for others. Sequence numbers alone would chain to another session's
  /// state.
  std::uint32_t base = 0;
  /// Of a stand-in: checksum of the packet with the same sequence.
  std::uint32_t stands_for = 0;
};

/// Where a chain of packets stands.
struct PacketChain {
  std::uint8_t backend = 0;
  std::uint8_t texture_id = 0;
  std::uint32_t sequence = 0;  ///< of the last packet; 0 before the first
  std::uint32_t checksum = 0;  ///< of the last packet

  /// The head of the next packet; `description` is the texture's description_hash(). Precondition:
  /// sequence is not the largest.
  [[nodiscard]] PacketHead next(std::uint32_t description, PacketType type) const;
  /// The same, but it stands for all packets that led to where `later`, which shares its states,
  /// stands. `type`: keyframe, delta or intra, no stand-in yet. Precondition: `later` has a packet
  /// and, unless it is a keyframe, is later.
  [[nodiscard]] PacketHead stand_in(std::uint32_t description, PacketType type,
                                    const PacketChain& later) const;
};

inline constexpr std::size_t kMaxPacketHead =
    4 + 5 + 5 + 4 + 4 + 5 + 10 + 10;  // Each at its longest.
inline constexpr std::size_t kPacketChecksum = 4;

/// Appends head, index buffer and guard bands; the payload and seal_packet() follow.
void write_packet_head(const PacketHead& head, std::span<const std::byte> index,
                       std::span<const std::byte> guard_bands, std::vector<std::byte>& out);
/// Appends the checksum of everything in `packet`, and returns it.
std::uint32_t seal_packet(std::vector<std::byte>& packet);
/// The checksum that a packet ends with. Precondition: parse_packet() accepts it.
[[nodiscard]] std::uint32_t packet_checksum(std::span<const std::byte> packet) noexcept;

/// The checksum that names the state after a packet: its own, or that of the one it stands for.
[[nodiscard]] std::uint32_t checksum_after(const PacketParts& parts,
                                           std::span<const std::byte> packet) noexcept;

/// Takes a packet apart without verifying its checksum. Everything a head can say is checked.
[[nodiscard]] Result<PacketParts> parse_packet(std::span<const std::byte> packet) noexcept;

}  // namespace gicodec
