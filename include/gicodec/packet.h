// Packets: one update of one texture as bytes (FORMAT.md, "Packet").
#pragma once

#include <gicodec/api.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace GICODEC_API gicodec {

using Packet = std::vector<std::byte>;

/// What a packet builds on, and which packets it replaces.
enum class PacketType : std::uint8_t {
  keyframe = 0,        ///< needs no reference; blocks that it does not list become zero
  delta = 1,           ///< builds on its reference; blocks that it does not list stay
  intra = 2,           ///< a delta that does not depend on what its blocks held before
  snapshot = 3,        ///< a keyframe that replaces all packets up to its sequence
  catch_up = 4,        ///< a delta that replaces all packets after its reference
  intra_catch_up = 5,  ///< an intra packet that replaces all packets after its reference
};
inline constexpr std::uint8_t kPacketTypes = 6;

[[nodiscard]] constexpr bool is_keyframe(PacketType type) noexcept {
  return type == PacketType::keyframe || type == PacketType::snapshot;
}
[[nodiscard]] constexpr bool is_intra(PacketType type) noexcept {
  return type == PacketType::intra || type == PacketType::intra_catch_up;
}
/// True if the packet replaces others: snapshot, catch_up, intra_catch_up.
[[nodiscard]] constexpr bool is_stand_in(PacketType type) noexcept {
  return type >= PacketType::snapshot;
}

/// What a decoder may spend on untrusted bytes. Calls check it first, and answer limit_exceeded.
struct DecodeLimits {
  std::uint64_t max_texture_bytes = std::uint64_t{1} << 30;  ///< one texture, tightly packed
  std::uint64_t max_packet_bytes = std::uint64_t{1} << 30;
  /// Peak memory of a decoder, or of a client with all its volumes (docs/guarantees.md).
  std::uint64_t max_total_bytes = std::uint64_t{4} << 30;
  /// Bytes of blocks that one packet, or one message of a server, may write or clear.
  std::uint64_t max_work_bytes = std::uint64_t{2} << 30;
  std::uint32_t max_textures = 256;  ///< in one container
  std::uint64_t max_description_bytes = std::uint64_t{1} << 20;
  /// Metadata of a container beside its description, unpacked, of all textures together.
  std::uint64_t max_metadata_bytes = std::uint64_t{64} << 20;
  std::uint64_t max_index_bytes = std::uint64_t{64} << 20;  ///< index parts read at once
};

}  // namespace gicodec
