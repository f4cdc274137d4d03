// Messages between a streaming server and its clients, over any transport that delimits messages
// (docs/protocol.md). For programs that do without Server or Client.
#pragma once

#include <gicodec/api.h>
#include <gicodec/delivery.h>
#include <gicodec/kind.h>
#include <gicodec/packet.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>
#include <gicodec/volume.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace GICODEC_API gicodec {

inline constexpr std::uint8_t kProtocolVersion = 1;

using Message = std::vector<std::byte>;

/// A message to send, in two pieces. Clients with the same second piece share it.
struct OutgoingMessage {
  Message head;
  std::shared_ptr<const Message> rest = nullptr;  ///< null: the message is `head`

  /// Both pieces, to be sent as one message, e.g. by writev(). They refer to this object.
  [[nodiscard]] std::array<std::span<const std::byte>, 2> pieces() const noexcept {
    return {std::span(head), rest == nullptr ? std::span<const std::byte>() : std::span(*rest)};
  }
  [[nodiscard]] std::size_t size() const noexcept {
    return head.size() + (rest == nullptr ? 0 : rest->size());
  }
  /// Both pieces as one message. out_of_memory.
  [[nodiscard]] Result<Message> joined() const;
};

// A *sync point* is an agreement of both ends on what the client holds. The client opens one with
// every Hello and Resync, which list the states it holds. Until the server answers to that sync
// point, the client drops what it receives. Updates of a sync point are numbered from 1 without
// gaps.

// Volumes come and go. Each list of volumes has a *generation*, 1 more than the list before. A
// client's message names the generation that it refers to, because a later one may give the number
// of a volume to another.

/// The state that a client holds of a stream, given by the last packet it applied.
struct HeldState {
  StreamId stream = {};
  std::uint32_t sequence = 0, checksum = 0;
};

/// Lets a client continue its session, once: the next Welcome brings another. Zeros: none.
using Ticket = std::array<std::byte, 16>;

/// Client: the first message of a connection.
struct Hello {
  std::uint32_t sync = 0;
  Ticket ticket = {};  ///< of the session to continue; zeros for a new one
  Delivery delivery = Delivery::unicast;
  Budget budget = {};
  std::string token = {};  ///< at most kMaxToken bytes of any value
  std::uint32_t generation = 0;
  std::vector<HeldState> held = {};
};

/// Client: it missed an update or could not apply one; `held` is all that it holds.
struct Resync {
  std::uint32_t sync = 0, generation = 0;
  std::vector<HeldState> held = {};
};

/// Client: it applied all updates of the sync point up to this number; 0: only the Welcome.
struct Acknowledge {
  std::uint32_t sync = 0, number = 0;
};

/// Client: its camera, in world units. The server decides which blocks that makes visible.
struct Viewpoint {
  Position eye{}, target{0, 0, -1}, up{0, 1, 0};
  float fov_y = 60;  ///< degrees, over 0 and below 180
  float aspect = 1;  ///< width over height, positive
  float time = 0;    ///< of the client's picture, seconds; 0: the client has no clock of its own
};

/// Client: the blocks of a group that it wants, whatever its viewpoint.
struct Subscribe {
  std::uint32_t generation = 0;
  std::uint16_t volume = 0;
  std::uint8_t group = 0;
  BlockMask blocks = {};  ///< one byte per block of the group
};

/// Why a connection is dropped. Numbers are stable.
enum class Reason : std::uint8_t {
  left = 0,            ///< the other end left
  version = 1,         ///< another protocol version
  token = 2,           ///< the token is wrong
  full = 3,            ///< the server takes no more clients
  malformed = 4,       ///< a message that breaks the protocol
  too_large = 5,       ///< a message beyond the limits
  flood = 6,           ///< more messages than the limits allow
  out_of_order = 7,    ///< a message that may not come now
  unknown_volume = 8,  ///< a volume or stream that does not exist
  silent = 9,          ///< no Hello in time
  stalled = 10,        ///< the client does not take or acknowledge updates
  shutdown = 11,       ///< the server ends
  replaced = 12,       ///< the session continues over another connection
  dismissed = 13,      ///< the server's operator ended it
  exhausted = 14,      ///< the server has no memory for the client
  unicast_full = 15,   ///< the server takes no more unicast clients
};
[[nodiscard]] std::string_view to_string(Reason reason) noexcept;

/// Either end: the connection ends.
struct Goodbye {
  Reason reason = Reason::left;
  std::string text = {};  ///< for people; at most kMaxText bytes of UTF-8
};

struct DescribedTexture {
  std::string name = {};
  Layout layout = {};       ///< of the publisher's views
  float largest_error = 0;  ///< of decoded records, as TextureEntry::largest_error
  friend bool operator==(const DescribedTexture&, const DescribedTexture&) = default;
};

/// A volume as its kind describes it. The receiver checks whether it knows the kind.
struct DescribedVolume {
  std::uint16_t id = 0;     ///< its number, below kMaxVolumes
  std::uint32_t added = 0;  ///< generation in which it came; unique together with id
  std::string name = {};
  std::uint8_t kind = 0;
  std::vector<std::byte> description = {};
  VolumeGeometry geometry = {};
  Grid region = {1, 1, 1};  ///< of shared streams, see regions_of()
  std::vector<DescribedTexture> textures = {};
  friend bool operator==(const DescribedVolume&, const DescribedVolume&) = default;
};

/// Server: the answer to a Hello.
struct Welcome {
  std::uint32_t sync = 0;
  Ticket ticket = {};    ///< for the session's next Hello
  bool resumed = false;  ///< the session of the Hello's ticket continues
  Delivery delivery = Delivery::unicast;
  std::uint64_t epoch = 0;  ///< of the publisher, see ServerOptions::epoch
  SceneId scene = {};
  std::uint32_t generation = 0;
  std::vector<DescribedVolume> volumes = {};  ///< ascending by id
};

/// Server: the volumes from here on. The client keeps those that it knows.
struct Volumes {
  std::uint32_t generation = 0;
  std::vector<DescribedVolume> volumes = {};  ///< as in a Welcome
};

/// Server: one update, which the client applies as a whole.
struct UpdateMessage {
  struct Part {
    StreamId stream;
    std::uint8_t tier = 0;  ///< the client takes part in every 2^tier-th update of the stream
    std::span<const std::byte> packet;
  };
  struct Proof {
    StreamId stream;
    std::uint64_t hash = 0;  ///< of the state after this update, see Decoder::state_hash()
  };
  std::uint32_t sync = 0, number = 0;
  std::uint32_t generation = 0;
  std::uint64_t update = 0;          ///< Server::updates()
  double time = 0;                   ///< of what is shown, seconds; the server's caller chooses it
  std::vector<Scroll> scrolls = {};  ///< of every volume, ascending by id
  std::vector<Part> parts = {};      ///< spans into the bytes given to read_message()
  std::vector<Proof> proofs = {};    ///< hashes for the client to check; usually none
};

// Tracks: shared streams for receivers that the publisher does not know (track_publisher.h).
/// The last objects of the tracks of consecutive regions of a texture.
struct TrackRun {
  StreamId first = {};       ///< of shared delivery
  std::uint32_t count = 1;   ///< of regions, from the first one on
  std::uint64_t age = 0;     ///< updates from the object to that of the message
  std::uint32_t number = 0;  ///< TrackObject::number
};

/// What a receiver begins with: the volumes, and the last snapshot of each track.
struct TrackList {
  std::uint64_t epoch = 0, update = 0;
  std::uint64_t round = 0;  ///< the snapshots have all changes up to this update
  SceneId scene = {};
  std::uint32_t generation = 0;
  std::vector<DescribedVolume> volumes = {};
  std::vector<TrackRun> snapshots = {};  ///< of number 0
};

/// A track's part of one update, or a snapshot of it.
struct TrackObject {
  std::uint64_t epoch = 0, update = 0;
  std::uint64_t previous = 0;  ///< update of the object on which this one builds; 0: a snapshot
  std::uint32_t number = 0;    ///< of objects after the last snapshot; 0: a snapshot
  std::uint32_t generation = 0;
  StreamId stream = {};
  std::vector<std::span<const std::byte>> packets = {};  ///< into the bytes of read_message()
  std::vector<std::uint64_t> proof = {};                 ///< one hash as in UpdateMessage, or none
};

/// The end of an update: all its objects came before.
struct TrackTick {
  std::uint64_t epoch = 0, update = 0;
  double time = 0;
  std::uint32_t generation = 0;
  std::vector<Scroll> scrolls = {};    ///< as in UpdateMessage
  std::uint64_t round = 0;             ///< TrackList::round of the last list
  std::vector<TrackRun> changed = {};  ///< tracks that changed after `round`
};

using AnyMessage = std::variant<Hello, Resync, Acknowledge, Viewpoint, Subscribe, Goodbye, Welcome,
                                UpdateMessage, Volumes, TrackList, TrackObject, TrackTick>;

/// What read_message() accepts. It checks before it allocates.
struct MessageLimits {
  std::uint64_t max_bytes = std::uint64_t{256} << 20;  ///< of a message
  std::uint32_t max_blocks = kMaxBlocks;               ///< of a list of blocks
};

inline constexpr std::size_t kMaxToken = 256;
inline constexpr std::size_t kMaxText = 1024;
inline constexpr std::size_t kMaxHeld = 32768;  ///< states; a stream not listed counts as not held
inline constexpr std::size_t kMaxVolumes = 1024;
inline constexpr std::uint8_t kMaxTier = 7;

/// Replaces `out` by the bytes of a message. invalid_argument if read_message() would refuse them.
Status write_message(const AnyMessage& message, Message& out);

/// Reads one whole message. The caller checks whether its volumes, streams and blocks exist.
/// Errors: truncated, corrupt, limit_exceeded, not_gicodec; unsupported_version for a Hello or
/// Welcome of another version.
[[nodiscard]] Result<AnyMessage> read_message(std::span<const std::byte> bytes,
                                              const MessageLimits& limits = {});

}  // namespace gicodec
