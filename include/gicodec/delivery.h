// What a streaming server delivers, to whom and how often: the words that Server, Client and
// protocol share.
#pragma once

#include <gicodec/api.h>
#include <gicodec/packet.h>

#include <compare>
#include <cstdint>
#include <memory>
#include <string_view>

namespace GICODEC_API gicodec {

/// How a texture is sent.
struct StreamedTexture {
  std::string_view texture;  ///< its name; read during the call
  /// In every n-th update, 1 or more; the same in a group that is bundled, and in groups
  /// that depend on one another.
  std::uint32_t interval = 1;
  /// Blocks whose records are all off by no more than this, see error_bound.h, at the client are
  /// not sent; 0 where any bit counts, and then every changed bit does.
  float threshold = 0;
  /// How far what clients decode may be off, see error_bound.h and EncoderOptions::max_error. Not
  /// together with a threshold; 0 where any bit counts.
  float max_error = 0;
  /// How far what is published is off already, as TextureEntry::largest_error; clients are told.
  float source_error = 0;
};

/// What a client may be sent in one update, all its textures together; 0 for no limit. Unicast
/// packets keep to it in every update wherever one block, in all textures in which it travels
/// together, does not exceed it. Of shared ones it is the average: clients take part in each region
/// in every update, every 2nd, 4th, ... 32nd.
struct Budget {
  std::uint32_t blocks = 0;
  std::uint64_t bytes = 0;
};

enum class Delivery : std::uint8_t {
  unicast,  ///< packets made for this client: exactly the blocks it sees, within its budget
  shared,   ///< packets of regions, made once for all who see one of their blocks
};

using ClientId = std::uint32_t;  ///< never given twice

/// Which chain a packet belongs to. Each has its own Decoder at the client.
struct StreamId {
  std::uint16_t volume = 0;
  std::uint8_t texture = 0;
  /// As RegionGrid counts them, or kWholeVolume.
  std::uint32_t region = kWholeVolume;

  static constexpr std::uint32_t kWholeVolume = UINT32_MAX;
  friend constexpr auto operator<=>(const StreamId&, const StreamId&) = default;
};

struct OutgoingPacket {
  StreamId stream;
  std::uint8_t tier = 0;  ///< the client takes part in every 2^tier-th update of the stream
  std::uint32_t blocks = 0;
  std::uint32_t sequence = 0;            ///< PacketInfo::sequence
  bool keyframe = false;                 ///< is_keyframe(PacketInfo::type)
  std::shared_ptr<const Packet> packet;  ///< shared by the clients of a region
};

/// Blocks in the packets of an update, shared ones counted once: what it cost.
struct WrittenBlocks {
  std::uint64_t all = 0;
  std::uint64_t unicast = 0;   ///< in those that Server::set_unicast_block_limit() limits
  std::uint64_t examined = 0;  ///< to choose those of unicast packets
};

}  // namespace gicodec
