// Distributor: the server below its messages (Stengel et al. §3.4). Textures of volumes go in,
// packets for every client come out. It knows what each client holds, sees and may receive, and
// which blocks are pending.
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
  /// Largest region of shared streams, in blocks along each axis; in a pool, x · y · z slots. All
  /// zeros: usual_region().
  Grid region{4, 4, 4};
  std::uint32_t max_clients = 4096;
  bool all_visible = false;  ///< clients see everything until set_visible(); false: nothing
  /// Packets of a texture that a client may leave unacknowledged and still revert by resume(): one
  /// an update, two if blocks moved.
  std::uint32_t max_unacknowledged = 48;
};

struct ServedVolume;

struct ClientState {
  std::uint64_t bytes_sent = 0, blocks_sent = 0, packets_sent = 0;
  std::uint32_t pending = 0;         ///< blocks that changed, are visible and were not sent yet
  std::uint32_t oldest_pending = 0;  ///< updates since the first of them changed
  std::string_view preset = {};      ///< chosen for its packets; empty if no texture has a choice
};

/// One thread at a time. update() uses DistributorOptions::threads.
class Distributor {
 public:
  /// Errors: unknown_backend, invalid_settings, invalid_argument.
  [[nodiscard]] static Result<Distributor> create(const DistributorOptions& options = {});
  Distributor(Distributor&&) noexcept;
  Distributor& operator=(Distributor&&) noexcept;
  ~Distributor();

  /// As Server::add_volume(). `described`: the description for clients; number, geometry and region
  /// are filled in.
  [[nodiscard]] Result<std::uint16_t> add_volume(const VolumeDesc& volume,
                                                 const VolumeGeometry& geometry,
                                                 std::span<const StreamedTexture> textures = {},
                                                 DescribedVolume described = {});
  /// `generation`: that of the list without the volume.
  Status remove_volume(std::uint16_t volume, std::uint32_t generation = 0);
  /// The volumes by number, removed ones included. Valid until a volume is added or removed.
  [[nodiscard]] std::span<const std::unique_ptr<ServedVolume>> table() const noexcept;
  // As in Server.
  Status publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view);
  Status publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view,
                 std::span<const std::uint32_t> blocks);
  Status scroll(std::uint16_t volume, const Scroll& scroll);
  [[nodiscard]] std::size_t volumes() const noexcept;
  [[nodiscard]] Result<VolumeGeometry> geometry(std::uint16_t volume) const noexcept;
  Status set_active(std::uint16_t volume, std::span<const std::uint8_t> active,
                    std::uint8_t group = 0);

  /// Adds a client, which holds nothing. limit_exceeded beyond max_clients.
  [[nodiscard]] Result<ClientId> connect(Delivery delivery = Delivery::unicast, Budget budget = {});
  Status disconnect(ClientId client);
  Status set_budget(ClientId client, Budget budget);
  /// Sets which blocks of a group the client sees: one byte per block. The client also gets
  /// the blocks that visible ones depend on.
  Status set_visible(ClientId client, std::uint16_t volume, std::span<const std::uint8_t> visible,
                     std::uint8_t group = 0);
  /// Makes no packets for a suspended client. Blocks that change meanwhile stay pending; of shared
  /// regions it later gets a catch-up if its state is still kept, else a snapshot.
  Status suspend(ClientId client, bool suspended);
  /// The client has applied all packets of a stream up to this sequence. Shared streams need no
  /// such call.
  Status acknowledge(ClientId client, StreamId stream, std::uint32_t sequence);
  /// The client holds the state of a stream after the packet of this sequence and checksum, and
  /// nothing later; 0 and 0: it holds nothing. The next updates send what it lacks, with a keyframe
  /// only if that state is no longer known. For a region to which the client does not subscribe,
  /// this applies once it does.
  Status resume(ClientId client, StreamId stream, std::uint32_t sequence, std::uint32_t checksum);

  /// Limits the blocks of an update in snapshots and catch-ups of shared streams. One packet is
  /// always made. Clients beyond the limit wait. 0, the default: no limit.
  void set_limit_for_few(std::uint32_t blocks) noexcept;
  /// Bytes per second that arrive at a client, by which its preset is chosen; 0: not known.
  Status set_throughput(ClientId client, double throughput);
  /// The last update took so many seconds, and may take `budget`: bounds the presets.
  void report_update_time(double elapsed, double budget) noexcept;
  /// Makes the next packets for all clients and drops those of the last update. After an error
  /// (out_of_memory, or one of the backend) clients that could not be served have no packets and
  /// hold what they held; their blocks stay pending for the next update().
  Status update();
  /// The last update's packets for a client, in the order in which the client must apply them.
  [[nodiscard]] std::span<const OutgoingPacket> packets(ClientId client) const noexcept;

  /// True if the budget's bytes kept blocks out of the last update.
  [[nodiscard]] bool held_back(ClientId client) const noexcept;
  /// False if the last update with room for unicast packets found nothing pending for the client.
  [[nodiscard]] bool has_pending(ClientId client) const noexcept;

  [[nodiscard]] Result<ClientState> state(ClientId client) const;
  [[nodiscard]] std::size_t memory_of(ClientId client) const noexcept;  ///< bytes held for it
  /// Shared delivery: blocks of the client's regions whose current contents were not sent.
  [[nodiscard]] std::uint32_t pending_shared(ClientId client) const noexcept;
  /// Decoder::state_hash() of a client that applied everything. invalid_argument for a stream that
  /// it does not have, or if it is not known what the client holds.
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

/// The options of each texture, by texture id. unknown_texture; invalid_name for one named twice.
[[nodiscard]] Result<std::vector<StreamedTexture>> by_texture(
    const VolumeDesc& volume, std::span<const StreamedTexture> textures);

}  // namespace gicodec
