// Streaming server (Stengel et al. §3.4) without a transport: textures of volumes go in,
// packets for every client come out. It knows what each client holds, finds what changed since,
// keeps to what the client sees and may receive, and remembers what it still owes.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/kind.h>
#include <gicodec/packet.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>
#include <gicodec/volume.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace gicodec {

/// How a texture is sent.
struct StreamedTexture {
  /// In every so manieth update, 1 or more; the same in a set that travels together, and in sets
  /// that name one another.
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

struct ServerOptions {
  std::string_view backend = "native";
  BackendSettings settings = {};
  std::vector<const Backend*> backends = {};  ///< further ones; must outlive the server
  unsigned threads = 1;                       ///< of publish() and update(), 1..256
  /// Blocks per region of shared streams, at most; of a pool x · y · z slots.
  Grid region{4, 4, 8};
  std::uint32_t max_clients = 4096;
  /// Updates of a texture that a client may leave unacknowledged and still take back by resume().
  std::uint32_t max_unacknowledged = 32;
};

/// What a client may be sent in one update, all its textures together; 0 for no limit. Own packets
/// keep to it in every update wherever one block, in all textures in which it travels together,
/// does not exceed it. Of shared ones it is the average: clients take part in each region in every
/// update, every 2nd, 4th, ... 32nd.
struct Budget {
  std::uint32_t blocks = 0;
  std::uint64_t bytes = 0;
};

enum class Delivery : std::uint8_t {
  own,     ///< packets made for this client: exactly the blocks it sees, within its budget
  shared,  ///< packets of regions, made once for all who see one of their blocks
};

using ClientId = std::uint32_t;  ///< never given twice

/// Which chain a packet belongs to. Each has its own Decoder at the client.
struct StreamId {
  std::uint16_t volume = 0;
  std::uint8_t texture = 0;
  /// Of RegionGrid, from 0 on, or kWholeVolume. Containers count from 1 and have 0 for the whole:
  /// TextureRegion::region is `region + 1`, in either case.
  std::uint32_t region = kWholeVolume;

  static constexpr std::uint32_t kWholeVolume = UINT32_MAX;
  friend constexpr auto operator<=>(const StreamId&, const StreamId&) = default;
};

struct OutgoingPacket {
  StreamId stream;
  std::uint8_t tier = 0;  ///< the client takes part in every 2^tier-th update of the stream
  std::uint32_t blocks = 0;
  std::shared_ptr<const Packet> packet;  ///< shared by the clients of a region
};

struct ClientState {
  std::uint64_t bytes_sent = 0, blocks_sent = 0, packets_sent = 0;
  std::uint32_t owed = 0;         ///< blocks that changed, are visible and were not sent yet
  std::uint32_t oldest_owed = 0;  ///< updates since the first of them changed
  std::size_t memory = 0;         ///< bytes held for this client
};

/// One thread at a time. update() uses further threads if told to.
class Server {
 public:
  /// Errors: unknown_backend, invalid_argument.
  [[nodiscard]] static Result<Server> create(const ServerOptions& options = {});
  Server(Server&&) noexcept;
  Server& operator=(Server&&) noexcept;
  ~Server();

  /// Adds a volume, whose geometry has the grid of its first set; returns its number. `textures`:
  /// by texture id; empty: as StreamedTexture has it. Layouts are those of the views to come.
  [[nodiscard]] Result<std::uint16_t> add_volume(const VolumeDesc& volume,
                                                 const VolumeGeometry& geometry,
                                                 std::span<const StreamedTexture> textures = {});
  /// The texture's contents from the next update on. A texture that is the presence of others comes
  /// before them, and all of them before the next update, which answers invalid_argument else.
  Status publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view);
  /// Moves a camera-locked volume: the sets with the geometry's grid. Blocks of planes that enter
  /// are sent anew, whatever is known of them; publish the textures with those planes before the
  /// next update. Masks of active and visible blocks are not changed. unsupported_backend if the
  /// backend remembers earlier payloads.
  Status scroll(std::uint16_t volume, const Scroll& scroll);
  [[nodiscard]] std::size_t volumes() const noexcept;
  /// Where a volume stands now.
  [[nodiscard]] Result<VolumeGeometry> geometry(std::uint16_t volume) const noexcept;
  /// Blocks of a set that are sent at all; empty for all of them.
  Status set_active(std::uint16_t volume, std::span<const std::uint8_t> active,
                    std::uint8_t set = 0);

  /// A client holds nothing at first and sees nothing. limit_exceeded beyond max_clients.
  [[nodiscard]] Result<ClientId> connect(Delivery delivery = Delivery::own, Budget budget = {});
  Status disconnect(ClientId client);
  Status set_budget(ClientId client, Budget budget);
  /// What the client sees of a set: one byte per block, e.g. by add_shading_probes(). Blocks that
  /// visible ones name are seen too.
  Status set_visible(ClientId client, std::uint16_t volume, std::span<const std::uint8_t> visible,
                     std::uint8_t set = 0);
  /// A client that cannot take packets now: none are made for it until told otherwise. What changes
  /// meanwhile stays owed; of shared regions that went on without it, it gets what it lacks
  /// afterwards: differences as long as what it holds is kept, else snapshots.
  Status suspend(ClientId client, bool suspended);
  /// The client has applied everything of a stream up to this sequence. Of shared streams nothing
  /// needs to be told.
  Status acknowledge(ClientId client, StreamId stream, std::uint32_t sequence);
  /// The client holds the state after this packet of a stream, given by sequence and checksum, and
  /// nothing later; 0 and 0 for none. What is missing is sent by and by, as a keyframe only if
  /// that state is not known any more. Of a region that it does not subscribe to this counts once
  /// it does.
  Status resume(ClientId client, StreamId stream, std::uint32_t sequence, std::uint32_t checksum);

  /// Most blocks of one update in packets of shared streams that are made for few: snapshots for
  /// those who join, differences for those who take fewer updates. One packet always is made; who
  /// has to wait is made up for later. 0: no limit, as at first.
  void set_extra_blocks(std::uint32_t blocks) noexcept;
  /// Makes the next packets for all clients. Those of the last update are dropped. After an error
  /// (out_of_memory, or one of the backend) who could not be served has no packets, holds what he
  /// held, and is owed what changed: the next update() makes up for it.
  Status update();
  /// What the last update has for a client, in the order in which it must be applied.
  [[nodiscard]] std::span<const OutgoingPacket> packets(ClientId client) const noexcept;

  /// True if the last update would have had more for the client with a budget of more bytes.
  [[nodiscard]] bool held_back(ClientId client) const noexcept;

  [[nodiscard]] Result<ClientState> state(ClientId client) const;
  /// Decoder::state_hash() of a client that applied everything. invalid_argument for a stream that
  /// it does not have, or of which it is not known what it holds.
  [[nodiscard]] Result<std::uint64_t> state_hash(ClientId client, StreamId stream) const;
  [[nodiscard]] const ServerOptions& options() const noexcept;
  [[nodiscard]] std::uint64_t updates() const noexcept;
  /// Blocks in the packets that the last update made, shared ones counted once: what it cost.
  struct WrittenBlocks {
    std::uint64_t all = 0;
    std::uint64_t for_few = 0;  ///< in own packets, and in those that set_extra_blocks() limits
  };
  [[nodiscard]] WrittenBlocks written() const noexcept;
  /// Bytes held for all: histories, regions, working memory.
  [[nodiscard]] std::size_t memory() const noexcept;

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
