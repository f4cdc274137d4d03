// Streaming server (Stengel et al. §3.4) without a transport: textures of volumes and messages of
// clients in, messages for them out, whatever carries them. Knows what each client holds, sends
// what changed since and is seen, checks everything clients say, keeps within limits.
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

using ConnectionId = std::uint32_t;  ///< a connection; never given twice

/// Who may connect.
struct ServerAccess {
  /// What clients must say in their Hello; empty: nobody is asked. Sent in clear: keeps strangers
  /// out, not eavesdroppers.
  std::string token = {};
  /// Asked with the token of each Hello, in place of a comparison with `token`: nothing lets the
  /// client in, a reason turns it away. For tokens of users; compare in constant time.
  std::function<std::optional<Reason>(ConnectionId, std::string_view token)> authorise = {};
  /// Fills with unpredictable bytes, for tickets; empty: the operating system's. Whoever can guess
  /// them can take over sessions: give one only for tests that must repeat themselves.
  std::function<Status(std::span<std::byte>)> random = {};
};

/// How many clients there may be, and what each may cost.
struct ServerLimits {
  std::uint32_t max_clients = 4096;      ///< sessions, those of lost connections included
  std::uint32_t max_connections = 1024;  ///< those without a Hello included
  /// Connections without a Hello. One more ends the one that has said nothing for longest.
  std::uint32_t max_waiting = 128;
  std::uint32_t max_unicast = 32;            ///< unicast sessions, which cost most
  std::uint32_t max_unicast_per_origin = 0;  ///< of those from one origin; 0: no limit
  std::uint64_t max_message_bytes = std::uint64_t{1} << 20;  ///< of a client's message
  /// Of a client, on average; one that sends more is dropped. Bursts of a second's worth pass, and
  /// one Subscribe to every group. A Subscribe counts for one more per 16,384 blocks of its volume.
  double messages_per_second = 200;
  /// Of a client, on average; one that asks more often is dropped. Bursts of ten seconds' worth
  /// pass.
  double resyncs_per_second = 1;
  /// Updates that a client did not acknowledge, at most. Each gets as much as it acknowledges
  /// without delay, which is less; these bound what one that acknowledges falsely may cost.
  std::uint32_t max_in_flight = 24;
  std::uint64_t max_in_flight_bytes = std::uint64_t{16} << 20;
  /// Of updates to a client, on average, whatever its budget asks; bursts of a second's worth pass,
  /// and one block or region always does. 0: no limit. Beyond it updates skip a client.
  std::uint64_t max_bytes_per_second = 0;
  /// Of updates to all clients together, shared out evenly. 0: no limit.
  std::uint64_t max_total_bytes_per_second = 0;
};

/// Seconds.
struct ServerTimeouts {
  double hello = 5;    ///< from connection to Hello
  double stall = 20;   ///< without acknowledging anything that is due
  double linger = 30;  ///< that the session of a lost connection is kept
};

struct ServerOptions {
  std::string_view backend = "native";
  BackendSettings settings = {};
  std::vector<const Backend*> backends = {};  ///< further ones; must outlive the server
  std::vector<const Kind*> kinds = {};        ///< besides the built-in ones; likewise
  Threads threads = {};                       ///< of publish() and update()
  /// Blocks per region of shared streams, at most; of a pool x · y · z slots. All zeros: by the
  /// size of a volume's blocks, 4×4×4 probes of 8×8 and 16×16 texels.
  Grid region{0, 0, 0};
  SceneId scene = {};  ///< told to clients
  /// Told to clients: numbers and times of updates of another epoch mean nothing beside these. 0:
  /// drawn at random.
  std::uint64_t epoch = 0;
  /// Seconds from one update to the next, as intended: what delays are measured by. 0: as it was of
  /// late, which lets them grow where updates themselves are late.
  double interval = 0;
  /// Bytes of the first update to a client, 2,048 or more. Twice as much follows whenever all of it
  /// was acknowledged without delay, so that a volume takes some updates to arrive at first: more
  /// where links are known to be fast.
  std::uint64_t first_update_bytes = 12 << 10;
  bool proofs = false;  ///< send a hash of every state, for checking
  ServerAccess access = {};
  ServerLimits limits = {};
  ServerTimeouts timeouts = {};
};

struct ServerEvent {
  enum class Kind : std::uint8_t {
    joined,      ///< a new session
    resumed,     ///< a session goes on over this connection
    viewpoint,   ///< the client told where it looks from
    subscribed,  ///< the client chose its blocks itself
    dropped,     ///< close the connection after sending what is left; see reason
    expired,     ///< a session without a connection was forgotten; connection is 0
  };
  Kind kind{};
  ConnectionId connection = 0;
  ClientId client = 0;           ///< 0 if there is none yet
  Reason reason = Reason::left;  ///< of those that are dropped
};

struct ConnectionStatistics {
  ClientId client = 0;
  Delivery delivery = Delivery::unicast;
  std::uint64_t updates = 0, bytes = 0, blocks = 0;  ///< made for it over this connection
  std::uint64_t in_flight_bytes = 0;
  std::uint32_t in_flight = 0;
  /// Updates left empty because it lagged, was over its rate, or waited for its turn.
  std::uint64_t skipped = 0;
  std::uint64_t update_bytes = 0;  ///< that an update may have, by what it acknowledges
  std::uint32_t resyncs = 0;
  bool lagging = false;
  /// Blocks of textures that it sees and was not sent as they are; shared: all of a region of which
  /// something was not. 0: nothing is missing but for what is under way.
  std::uint32_t pending = 0;
  std::uint32_t oldest_pending = 0;  ///< unicast: updates since the first of them changed
  std::size_t memory = 0;            ///< bytes held for it
};

/// One thread at a time. Times are seconds on any clock that does not go backwards.
class Server {
 public:
  /// unknown_backend; invalid_name of the scene; invalid_settings; invalid_argument; out_of_memory;
  /// io_failed or those of ServerAccess::random where there is no randomness for tickets. Where
  /// that fails later, clients are turned away with Reason::full.
  [[nodiscard]] static Result<Server> create(const ServerOptions& options = {});
  Server(Server&&) noexcept;
  Server& operator=(Server&&) noexcept;
  ~Server();

  // Volumes. Further errors of these calls: unknown_volume, unknown_texture, unknown_group.

  /// Adds a volume, whose geometry has the grid of its first group; returns its number. `name`:
  /// UTF-8. Textures that are not listed are sent as StreamedTexture has it. Layouts are those of
  /// the views to come. At any time: clients are told, and see everything of it until told
  /// otherwise. invalid_name; unknown_kind if it is neither built in nor given; invalid_description
  /// if what the kind writes does not give the volume back; invalid_geometry, invalid_interval,
  /// invalid_bound; unsupported_format, unsupported_shape, unsupported_backend; limit_exceeded.
  [[nodiscard]] Result<std::uint16_t> add_volume(std::string name, const VolumeDesc& volume,
                                                 const VolumeGeometry& geometry,
                                                 std::span<const StreamedTexture> textures = {});
  /// Clients drop it with the next update. Its number may be given to another volume afterwards.
  Status remove_volume(std::uint16_t volume);
  /// The texture's contents from the next update on; the view is read during the call. A texture
  /// that is the presence of others comes before them, and all of them before the next update,
  /// which answers presence_missing else. view_too_small, presence_invalid.
  Status publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view);
  /// The same where nothing but the listed blocks may have changed: no others are looked at, but
  /// for those that never were, that entered by scrolling, or whose presence changed. In any order;
  /// block_out_of_range, block_repeated.
  Status publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view,
                 std::span<const std::uint32_t> blocks);
  /// Moves a camera-locked volume: the groups with the geometry's grid. Blocks of planes that enter
  /// are sent anew once the textures were published with them, whichever blocks that lists; do so
  /// before the next update, or clients have nothing there, and who joins what was there before.
  /// Masks of active and visible blocks are not changed. invalid_geometry; unsupported_backend if
  /// the backend is stateful.
  Status scroll(std::uint16_t volume, const Scroll& scroll);
  [[nodiscard]] std::size_t volumes() const noexcept;  ///< how many there are
  /// Where a volume stands now.
  [[nodiscard]] Result<VolumeGeometry> geometry(std::uint16_t volume) const noexcept;
  /// Blocks of a group that are sent at all, one byte each; empty for all of them. mask_mismatch.
  Status set_active(std::uint16_t volume, std::span<const std::uint8_t> active,
                    std::uint8_t group = 0);

  // Connections.

  /// A transport has a new connection. limit_exceeded, out_of_memory, invalid_time: close it at
  /// once. `origin`: who counts as one stranger, e.g. an address; empty: not known.
  [[nodiscard]] Result<ConnectionId> connect(double now, std::string_view origin = {});
  /// A message of a client. Never an error of the caller's: a connection that breaks the rules is
  /// dropped. Messages of dropped connections are ignored.
  void receive(ConnectionId connection, std::span<const std::byte> message, double now);
  /// The connection is gone; its session is kept for a while.
  void disconnect(ConnectionId connection, double now);
  /// Ends a connection and its session.
  void drop(ConnectionId connection, Reason reason);
  /// What the client of a session sees of a group: one byte per block, e.g. by
  /// add_shading_probes(); empty for nothing. Blocks on which visible ones depend are seen too.
  /// Until it is told, and the client has not chosen its blocks itself, it sees everything; the
  /// later of both words counts. unknown_connection, mask_mismatch.
  Status set_visible(ConnectionId connection, std::uint16_t volume,
                     std::span<const std::uint8_t> visible, std::uint8_t group = 0);

  // Updates.

  /// Makes the next packets for all sessions, and the messages that carry them. `time` is told to
  /// the clients. After invalid_time nothing has happened. After another error there may have been
  /// an update, see updates(), and it is no reason to stop: connections that could not be served
  /// got nothing this time, which stays pending, or were dropped; for the others all is well.
  /// presence_missing: textures whose presence was published without them are left out.
  Status update(double now, double time);
  /// Most blocks of one update in packets that are made for few clients: of shared streams
  /// snapshots for those who join and catch-ups for those who take fewer updates, where one packet
  /// always is made; and as many again in unicast packets, of which each session with something
  /// pending may take an even share, or its turn where that is less than a block. What is left out
  /// stays pending. 0: no limit, as at first.
  void set_unicast_block_limit(std::uint32_t blocks) noexcept;
  /// How long the last update took, and how long one may take: adapts the above, less while updates
  /// take too long, and more again while there is time. Seconds; what is no time changes nothing.
  void report_update_time(double elapsed, double budget) noexcept;
  /// Looks after timeouts; update() does it too.
  void tick(double now);
  /// Messages for a client, oldest first, moved out: send them reliably and in this order.
  [[nodiscard]] std::vector<OutgoingMessage> take_messages(ConnectionId connection);
  [[nodiscard]] std::vector<ServerEvent> take_events();
  /// What the last update has for a connection, in the order in which it is applied.
  [[nodiscard]] std::span<const OutgoingPacket> packets(ConnectionId connection) const noexcept;
  [[nodiscard]] std::uint64_t updates() const noexcept;
  [[nodiscard]] WrittenBlocks written() const noexcept;  ///< by the last update

  [[nodiscard]] Result<std::vector<ConnectionId>> connections()
      const;  ///< with a session; out_of_memory
  [[nodiscard]] std::optional<ClientId> client(ConnectionId connection) const;
  /// Where a client looks from, if it said so.
  [[nodiscard]] std::optional<Viewpoint> viewpoint(ConnectionId connection) const;
  /// Of a connection that has or had a session, until disconnect().
  [[nodiscard]] std::optional<ConnectionStatistics> statistics(ConnectionId connection) const;
  /// Seconds from making an update to its acknowledgement, since the last call.
  [[nodiscard]] std::vector<float> take_latencies(ConnectionId connection);
  [[nodiscard]] std::size_t memory() const noexcept;  ///< bytes

 private:
  struct GICODEC_LOCAL State;
  explicit Server(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
