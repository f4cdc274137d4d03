// What a streaming server delivers, and how often: types that Server, Client, protocol and
// containers share.
#pragma once

#include <gicodec/api.h>
#include <gicodec/backend.h>
#include <gicodec/packet.h>
#include <gicodec/settings.h>
#include <gicodec/texture.h>

#include <compare>
#include <cstdint>
#include <memory>
#include <string_view>

namespace GICODEC_API gicodec {

/// How a texture is sent.
struct StreamedTexture {
  std::string_view texture;  ///< its name; read during the call
  /// The texture is sent in every n-th update, 1 or more. Equal for all textures of a bundled group
  /// and of groups that depend on one another.
  std::uint32_t interval = 1;
  /// A changed block is not sent while all its records at the client are off by no more than this,
  /// see error_bound.h. 0: every changed bit counts.
  float threshold = 0;
  /// Error bound of records that clients decode, see error_bound.h and EncoderOptions::max_error.
  /// 0: lossless; must be 0 if `threshold` is not.
  float max_error = 0;
  /// Largest error of the published records themselves, as TextureEntry::largest_error. Clients
  /// learn the error of both together.
  float source_error = 0;
  /// Codes the texture, with `settings`; null: ServerOptions has both. Must outlive the server.
  /// Where a backend is_stateful(), a shared stream is one region unless ServerOptions cuts it, and
  /// a client that missed an update waits for the next keyframe, which all get: every 16th update
  /// at most. A lossy backend needs bounds of 0 above, and no client may have unicast delivery: all
  /// hold what the backend's packets decode to.
  const Backend* backend = nullptr;
  BackendSettings settings = {};
};

/// What one update to a client may contain, in all textures together; 0: no limit. Unicast packets
/// keep to it in every update, unless a single block exceeds it in the textures of its bundle.
/// Shared packets keep to it on average: a client takes part in each region in every update, every
/// 2nd, 4th, ... 32nd.
struct Budget {
  std::uint32_t blocks = 0;
  std::uint64_t bytes = 0;
};

enum class Delivery : std::uint8_t {
  unicast,  ///< packets made for one client: exactly the blocks it sees, within its budget
  shared,   ///< packets of regions, made once for all clients that see one of their blocks
};

using ClientId = std::uint32_t;  ///< never given twice

/// The chain that a packet belongs to. The client has a Decoder for each.
struct StreamId {
  std::uint16_t volume = 0;
  std::uint8_t texture = 0;
  /// Its number in RegionGrid; kWholeVolume for unicast delivery.
  std::uint32_t region = kWholeVolume;

  static constexpr std::uint32_t kWholeVolume = UINT32_MAX;
  friend constexpr auto operator<=>(const StreamId&, const StreamId&) = default;
};

/// What identifies a track to people and in subjects.
struct TrackName {
  std::string_view volume, texture;  ///< owned by what returned the name
  Grid place;                        ///< of its region among those of the texture
};

struct OutgoingPacket {
  StreamId stream;
  std::uint8_t tier = 0;  ///< the client takes part in every 2^tier-th update of the stream
  std::uint32_t blocks = 0;
  std::uint32_t sequence = 0;            ///< PacketInfo::sequence
  bool keyframe = false;                 ///< is_keyframe(PacketInfo::type)
  std::shared_ptr<const Packet> packet;  ///< shared by the clients of a region
};

/// Blocks in the packets of an update, shared packets counted once: a measure of its cost.
struct WrittenBlocks {
  std::uint64_t all = 0;
  std::uint64_t for_few = 0;   ///< in packets that Server::set_limit_for_few() limits
  std::uint64_t examined = 0;  ///< candidates for unicast packets
};

}  // namespace gicodec
