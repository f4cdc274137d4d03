// Streaming server (Stengel et al. §3.4) without a transport: textures of volumes go in,
// packets for every client come out. It knows what each client holds, finds what changed since,
// keeps to what the client sees and may receive, and knows what is pending.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/delivery.h>
#include <gicodec/kind.h>
#include <gicodec/protocol.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>
#include <gicodec/volume.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace gicodec {

struct DistributorOptions {
  std::string_view backend = "native";
  BackendSettings settings = {};
  std::vector<const Backend*> backends = {};  ///< further ones; must outlive the server
  Threads threads = {};                       ///< of publish() and update()
  /// Blocks per region of shared streams, at most; of a pool x · y · z slots. All zeros: by the
  /// size of a volume's blocks, usual_region().
  Grid region{4, 4, 4};
  std::uint32_t max_clients = 4096;
  bool all_visible = false;  ///< what clients see until told otherwise; false: nothing
  /// Updates of a texture that a client may leave unacknowledged and still take back by resume().
  std::uint32_t max_unacknowledged = 32;
};

struct ServedVolume;

struct ClientState {
  std::uint64_t bytes_sent = 0, blocks_sent = 0, packets_sent = 0;
  std::uint32_t pending = 0;         ///< blocks that changed, are visible and were not sent yet
  std::uint32_t oldest_pending = 0;  ///< updates since the first of them changed
};

/// One thread at a time. update() uses further threads if told to.
class Distributor {
 public:
  /// Errors: unknown_backend, invalid_settings, invalid_argument.
  [[nodiscard]] static Result<Distributor> create(const DistributorOptions& options = {});
  Distributor(Distributor&&) noexcept;
  Distributor& operator=(Distributor&&) noexcept;
  ~Distributor();

  /// Adds a volume, whose geometry has the grid of its first group; returns its number. Textures
  /// that are not named: as StreamedTexture has it. Layouts are those of the views to come.
  /// `described`: what else is told of it: all but number, geometry and region.
  [[nodiscard]] Result<std::uint16_t> add_volume(const VolumeDesc& volume,
                                                 const VolumeGeometry& geometry,
                                                 std::span<const StreamedTexture> textures = {},
                                                 DescribedVolume described = {});
  /// Its number may be given to another volume afterwards. `generation`: that of the list without
  /// it.
  Status remove_volume(std::uint16_t volume, std::uint32_t generation = 0);
  /// The volumes by number, with those that were removed; until the next change.
  [[nodiscard]] std::span<const std::unique_ptr<ServedVolume>> table() const noexcept;
  /// The texture's contents from the next update on. A texture that is the presence of others comes
  /// before them, and all of them before the next update, which answers presence_missing else.
  Status publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view);
  /// The same where nothing but the listed blocks may have changed: no others are looked at, but
  /// for those that never were, that entered by scrolling, or whose presence changed.
  /// block_out_of_range, block_repeated.
  Status publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view,
                 std::span<const std::uint32_t> blocks);
  /// Moves a camera-locked volume: the groups with the geometry's grid. Blocks of planes that enter
  /// are sent anew, whatever is known of them; publish the textures with those planes before the
  /// next update. Masks of active and visible blocks are not changed. unsupported_backend if the
  /// backend is stateful.
  Status scroll(std::uint16_t volume, const Scroll& scroll);
  [[nodiscard]] std::size_t volumes() const noexcept;
  /// Where a volume stands now.
  [[nodiscard]] Result<VolumeGeometry> geometry(std::uint16_t volume) const noexcept;
  /// Blocks of a group that are sent at all; empty for all of them.
  Status set_active(std::uint16_t volume, std::span<const std::uint8_t> active,
                    std::uint8_t group = 0);

  /// A client holds nothing at first. limit_exceeded beyond max_clients.
  [[nodiscard]] Result<ClientId> connect(Delivery delivery = Delivery::unicast, Budget budget = {});
  Status disconnect(ClientId client);
  Status set_budget(ClientId client, Budget budget);
  /// What the client sees of a group: one byte per block, e.g. by add_shading_probes(). Blocks that
  /// visible ones depend on are seen too.
  Status set_visible(ClientId client, std::uint16_t volume, std::span<const std::uint8_t> visible,
                     std::uint8_t group = 0);
  /// A client that cannot take packets now: none are made for it until told otherwise. What changes
  /// meanwhile stays pending; of shared regions that went on without it, it gets what it lacks
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
  void set_unicast_block_limit(std::uint32_t blocks) noexcept;
  /// Makes the next packets for all clients. Those of the last update are dropped. After an error
  /// (out_of_memory, or one of the backend) who could not be served has no packets, holds what he
  /// held, and has pending what changed: the next update() makes up for it.
  Status update();
  /// What the last update has for a client, in the order in which it must be applied.
  [[nodiscard]] std::span<const OutgoingPacket> packets(ClientId client) const noexcept;

  /// True if the last update would have had more for the client with a budget of more bytes.
  [[nodiscard]] bool held_back(ClientId client) const noexcept;
  /// False if the last update that could have had unicast packets for the client had nothing for
  /// it.
  [[nodiscard]] bool has_pending(ClientId client) const noexcept;

  [[nodiscard]] Result<ClientState> state(ClientId client) const;
  [[nodiscard]] std::size_t memory_of(ClientId client) const noexcept;  ///< bytes held for it
  /// Of shared delivery: blocks of the regions that the client sees and was not sent as they are.
  [[nodiscard]] std::uint32_t pending_shared(ClientId client) const noexcept;
  /// Decoder::state_hash() of a client that applied everything. invalid_argument for a stream that
  /// it does not have, or of which it is not known what it holds.
  [[nodiscard]] Result<std::uint64_t> state_hash(ClientId client, StreamId stream) const;
  [[nodiscard]] const DistributorOptions& options() const noexcept;
  [[nodiscard]] std::uint64_t updates() const noexcept;
  [[nodiscard]] WrittenBlocks written() const noexcept;
  /// Bytes held for all: histories, regions, working memory.
  [[nodiscard]] std::size_t memory() const noexcept;

 private:
  struct State;
  explicit Distributor(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

/// What is said of each texture, by texture id. unknown_texture; invalid_name for one named twice.
[[nodiscard]] Result<std::vector<StreamedTexture>> by_texture(
    const VolumeDesc& volume, std::span<const StreamedTexture> textures);

}  // namespace gicodec
