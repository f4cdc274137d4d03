// Streaming server (Stengel et al. §3.4) without a transport: takes textures of volumes and
// messages of clients, returns messages for the clients. It knows what each client holds, sends the
// visible blocks that changed since, checks all that clients send, and keeps within limits.
#pragma once

#include <gicodec/api.h>
#include <gicodec/backend.h>
#include <gicodec/delivery.h>
#include <gicodec/protocol.h>
#include <gicodec/settings.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>
#include <gicodec/volume.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace GICODEC_API gicodec {

using ConnectionId = std::uint32_t;  ///< never given twice

/// Which clients may connect.
struct ServerAccess {
  /// The token that a Hello must contain; empty: any. It travels in clear unless the transport
  /// encrypts: it keeps out strangers, not eavesdroppers.
  std::string token = {};
  /// Called with the token of each Hello, instead of the comparison with `token`: nullopt admits
  /// the client, a reason rejects it. For a token per user; compare in constant time.
  std::function<std::optional<Reason>(ConnectionId, std::string_view token)> authorise = {};
  /// Fills the span with unpredictable bytes, for tickets; empty: the operating system's. A guessed
  /// ticket gives a session away: set this only in tests that must be reproducible.
  std::function<Status(std::span<std::byte>)> random = {};
};

/// How many clients there may be, and what each may cost.
struct ServerLimits {
  std::uint32_t max_clients = 4096;      ///< sessions, those of lost connections included
  std::uint32_t max_connections = 1024;  ///< those without a Hello included
  /// Connections without a Hello. One more drops the oldest of them.
  std::uint32_t max_waiting = 128;
  std::uint32_t max_unicast = 32;            ///< unicast sessions, which cost most
  std::uint32_t max_unicast_per_origin = 0;  ///< unicast sessions from one origin; 0: no limit
  std::uint64_t max_message_bytes = std::uint64_t{1} << 20;  ///< of a client's message
  /// Messages of a client, on average; the server drops a client that sends more. Bursts of one
  /// second's worth pass, and a Subscribe to every group. A Subscribe counts as 1 message, and 1
  /// more per 16,384 blocks of its volume.
  double messages_per_second = 200;
  /// Resyncs of a client, on average; the server drops a client that sends more. Bursts of ten
  /// seconds' worth pass.
  double resyncs_per_second = 1;
  /// Updates that a client has not acknowledged. Congestion control keeps an honest client below
  /// these two limits; they bound the cost of a client that acknowledges falsely.
  std::uint32_t max_in_flight = 24;
  std::uint64_t max_in_flight_bytes = std::uint64_t{16} << 20;
  /// Bytes of updates to a client, on average, whatever its budget; updates skip a client beyond
  /// it. Bursts of one second's worth pass, and always one block or region. 0: no limit.
  std::uint64_t max_bytes_per_second = 0;
  /// Bytes of updates to all clients together, in even shares. 0: no limit.
  std::uint64_t max_total_bytes_per_second = 0;
};

/// Seconds.
struct ServerTimeouts {
  double hello = 5;    ///< from connection to Hello
  double stall = 20;   ///< without an acknowledgement while updates are in flight
  double linger = 30;  ///< for which a session outlives its connection
};

struct ServerOptions {
  std::string_view backend = "native";
  /// Without a preset the server chooses those of native packets, see docs/streaming.md.
  BackendSettings settings = {};
  std::vector<const Backend*> backends = {};  ///< further ones; must outlive the server
  std::vector<const Kind*> kinds = {};        ///< further ones; must outlive the server
  Threads threads = {};                       ///< of publish() and update()
  /// Largest region of shared streams, in blocks along each axis; in a pool, x · y · z slots. All
  /// zeros: by the size of a volume's blocks, e.g. 4×4×4 for probes of 8×8 and 16×16 texels.
  Grid region{0, 0, 0};
  SceneId scene = {};  ///< sent to clients
  /// Sent to clients. Numbers and times of updates are comparable within an epoch. 0: random.
  std::uint64_t epoch = 0;
  /// Intended seconds between updates, by which congestion control measures delays. 0: the recent
  /// time between updates; late updates then permit longer delays.
  double interval = 0;
  /// Bytes of the first update to a client, 2,048 or more; doubled whenever a client acknowledges
  /// all without delay. Choose more where links are known to be fast.
  std::uint64_t first_update_bytes = 12 << 10;
  /// Send a hash of each stream's state, for clients to check. Messages are then not shared among
  /// clients.
  bool proofs = false;
  ServerAccess access = {};
  ServerLimits limits = {};
  ServerTimeouts timeouts = {};
};

struct ServerEvent {
  enum class Type : std::uint8_t {
    joined,      ///< a new session
    resumed,     ///< a session continues over this connection
    viewpoint,   ///< the client sent a Viewpoint
    subscribed,  ///< the client sent a Subscribe
    dropped,     ///< send take_messages(), then close the connection; see reason
    expired,     ///< a session without a connection ended; connection is 0
  };
  Type type{};
  ConnectionId connection = 0;
  ClientId client = 0;           ///< 0 before the connection has a session
  Reason reason = Reason::left;  ///< why the server dropped it
};

struct ConnectionStatistics {
  ClientId client = 0;
  Delivery delivery = Delivery::unicast;
  std::uint64_t updates = 0, bytes = 0, blocks = 0;  ///< made for this connection
  std::uint64_t in_flight_bytes = 0;                 ///< of updates not acknowledged
  std::uint32_t in_flight = 0;                       ///< updates not acknowledged
  /// Updates left empty because the client lagged, was over its rate, or waited for its turn.
  std::uint64_t skipped = 0;
  std::uint64_t update_bytes = 0;  ///< that congestion control allows in an update
  std::uint32_t resyncs = 0;
  bool lagging = false;
  /// Visible blocks whose current contents were not sent, counted once per bundle. Shared delivery
  /// counts all blocks of a region with such a block. 0: all is sent.
  std::uint32_t pending = 0;
  std::uint32_t oldest_pending = 0;  ///< unicast: updates since the first of them changed
  std::size_t memory = 0;            ///< bytes held for the client
  std::string_view preset = {};      ///< that the server chose; empty: none. Static storage
};

/// One thread at a time. `now` is in seconds on any clock that does not go backwards.
class Server {
 public:
  /// Errors: unknown_backend; invalid_name (scene); invalid_settings; invalid_argument;
  /// out_of_memory; io_failed, or those of ServerAccess::random, without randomness for tickets. If
  /// randomness fails later, the server rejects clients with Reason::full.
  [[nodiscard]] static Result<Server> create(const ServerOptions& options = {});
  Server(Server&&) noexcept;
  Server& operator=(Server&&) noexcept;
  ~Server();

  // Volumes. Errors of all these calls: unknown_volume, unknown_texture, unknown_group.

  /// Adds a volume, also while clients are connected, and returns its number. `geometry` has the
  /// grid of the first group. `name`: UTF-8. Layouts are those of the views to publish. Textures
  /// that are not listed get the defaults of StreamedTexture. Clients see all blocks until
  /// set_visible() or a Subscribe. Errors: invalid_name; unknown_kind for one that is neither built
  /// in nor in ServerOptions; invalid_description if the kind cannot read back what it writes;
  /// invalid_geometry, invalid_interval, invalid_bound; unsupported_format, unsupported_shape,
  /// unsupported_backend; limit_exceeded.
  [[nodiscard]] Result<std::uint16_t> add_volume(std::string name, const VolumeDesc& volume,
                                                 const VolumeGeometry& geometry,
                                                 std::span<const StreamedTexture> textures = {});
  /// Clients drop the volume with the next update. A later volume may get its number.
  Status remove_volume(std::uint16_t volume);
  /// Sets a texture's contents from the next update on; reads the view during the call. `texture`:
  /// its number, which counts through the groups of the volume. After a texture that holds the
  /// presence of others, publish these others before the next update, which otherwise answers
  /// presence_missing. Errors: view_too_small, presence_invalid.
  Status publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view);
  /// The same if only the listed blocks, in any order, may have changed. Reads only these, and
  /// blocks that were never read, entered by scrolling, or have another presence. Errors also:
  /// block_out_of_range, block_repeated.
  Status publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view,
                 std::span<const std::uint32_t> blocks);
  /// Moves the groups of a camera-locked volume that have the geometry's grid. Publish their
  /// textures before the next update: publish() then reads the entering blocks, listed or not.
  /// Otherwise clients have nothing there, and new clients the old contents. Active and visible
  /// masks do not change. invalid_geometry; unsupported_backend if the backend is_stateful().
  Status scroll(std::uint16_t volume, const Scroll& scroll);
  [[nodiscard]] std::size_t volumes() const noexcept;  ///< their number
  [[nodiscard]] Result<VolumeGeometry> geometry(std::uint16_t volume) const noexcept;
  /// Excludes inactive blocks of a group from all updates: one byte per block, 0 for inactive;
  /// empty: all are active. mask_mismatch.
  Status set_active(std::uint16_t volume, std::span<const std::uint8_t> active,
                    std::uint8_t group = 0);

  // Connections.
  /// Call this for each new connection of a transport. `origin` identifies the peer, e.g. by its
  /// address; empty: unknown. On limit_exceeded, out_of_memory or invalid_time close the
  /// connection.
  [[nodiscard]] Result<ConnectionId> connect(double now, std::string_view origin = {});
  /// Takes a message of a client. Drops a connection that breaks the rules; ignores messages of
  /// dropped connections.
  void receive(ConnectionId connection, std::span<const std::byte> message, double now);
  /// Call this when a connection is lost or closed. Keeps its session for ServerTimeouts::linger.
  void disconnect(ConnectionId connection, double now);
  /// Ends a connection and its session.
  void drop(ConnectionId connection, Reason reason);
  /// Sets which blocks of a group the client sees: one byte per block, e.g. by
  /// add_shading_probes(); empty: none. The client also gets the blocks that they depend on. A
  /// client sees everything at first; the last set_visible() or Subscribe counts. Errors:
  /// unknown_connection, mask_mismatch.
  Status set_visible(ConnectionId connection, std::uint16_t volume,
                     std::span<const std::uint8_t> visible, std::uint8_t group = 0);

  // Updates.

  /// Makes the next packets for all sessions, and the messages that carry them. `time`: of what is
  /// shown, seconds; sent to clients. invalid_time changes nothing. After any other error go on:
  /// if updates() has grown, there was an update. It served all connections but those that failed,
  /// which the server dropped, or sent nothing and keeps their blocks pending. presence_missing:
  /// the update left out textures that were not published after their presence.
  Status update(double now, double time);
  /// Limits the blocks that an update codes for few clients: so many in snapshots and catch-ups of
  /// shared streams (at least one packet is always made), and so many in unicast packets. Sessions
  /// with pending blocks get even shares of the latter, or take turns if a share is less than a
  /// block. Blocks beyond the limit stay pending. 0, the default: no limit.
  void set_limit_for_few(std::uint32_t blocks) noexcept;
  /// Adapts that limit and the presets to choose from: lowers it while updates take longer than
  /// `budget`, and makes these "turbo"; else raises it. `elapsed`: how long the last update took.
  /// In seconds; ignores values that are no times. Without reports no preset is slower than "fast".
  void report_update_time(double elapsed, double budget) noexcept;
  /// Enforces timeouts; update() does so too.
  void tick(double now);
  /// Moves out the messages for a client, oldest first. Send them reliably and in this order.
  [[nodiscard]] std::vector<OutgoingMessage> take_messages(ConnectionId connection);
  /// Moves out what happened, oldest first. Take them after each call: beyond some 65,000 the
  /// oldest are dropped.
  [[nodiscard]] std::vector<ServerEvent> take_events();
  /// The last update's packets for a connection, in the order in which the client applies them.
  [[nodiscard]] std::span<const OutgoingPacket> packets(ConnectionId connection) const noexcept;
  [[nodiscard]] std::uint64_t updates() const noexcept;  ///< their number so far
  [[nodiscard]] WrittenBlocks written() const noexcept;  ///< by the last update

  /// Those with a session; out_of_memory.
  [[nodiscard]] Result<std::vector<ConnectionId>> connections() const;
  [[nodiscard]] std::optional<ClientId> client(ConnectionId connection) const;
  /// The client's last Viewpoint, if it sent one.
  [[nodiscard]] std::optional<Viewpoint> viewpoint(ConnectionId connection) const;
  /// Of a connection that has or had a session, until disconnect().
  [[nodiscard]] std::optional<ConnectionStatistics> statistics(ConnectionId connection) const;
  /// Seconds from each update to its acknowledgement, since the last call; 4,096 at most.
  [[nodiscard]] std::vector<float> take_latencies(ConnectionId connection);
  [[nodiscard]] std::size_t memory() const noexcept;  ///< bytes held for all

 private:
  friend class TrackPublisher;
  struct GICODEC_LOCAL State;
  explicit Server(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
