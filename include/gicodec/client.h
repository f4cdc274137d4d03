// Streaming client (Stengel et al. §3.4) without a transport: messages of a server in, textures of
// its volumes out.
#pragma once

#include <gicodec/api.h>
#include <gicodec/backend.h>
#include <gicodec/packet.h>
#include <gicodec/protocol.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>
#include <gicodec/volume.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace GICODEC_API gicodec {

/// A texture as the client holds it.
struct ClientTexture {
  std::string name;
  TextureDesc desc;
  std::vector<std::byte> texels;  ///< tightly packed, guard bands included
  /// Per block, ClientFrame::serial when its block was last replaced. 0: nothing was received for
  /// the place where the block stands now. What to upload, and what not to shade with.
  std::vector<std::uint64_t> changed;
  /// How far records may be off, as the server says, see FORMAT.md, "Container"; 0: bit by bit.
  float largest_error = 0;

  [[nodiscard]] ConstTextureView view() const noexcept { return {texels}; }
  /// Replaces `out` by the blocks that were replaced after the frame of that serial, ascending.
  /// Keeps its capacity. out_of_memory.
  Status changed_blocks(std::uint64_t since, std::vector<std::uint32_t>& out) const;
};

struct ClientVolume {
  std::uint16_t id = 0;  ///< that the server gave it
  /// Counts the volumes that the client has had, of all its sessions: what a renderer knows its own
  /// textures of it by. `id` is given again.
  std::uint64_t instance = 0;
  std::string name;
  VolumeDesc desc;
  VolumeGeometry geometry;
  Grid region;                          ///< that it is cut by, for shared streams
  std::vector<ClientTexture> textures;  ///< of all groups
};

/// The volumes after one update: everything in it belongs together.
struct ClientFrame {
  std::uint64_t epoch = 0;            ///< of the publisher: `update` and `time` count in it
  std::uint64_t serial = 0;           ///< counts the updates applied; 0 before the first
  std::uint64_t began = 0;            ///< serial when the session began: nothing older is left
  std::uint64_t update = 0;           ///< the server's number of it
  double time = 0;                    ///< what the server shows, seconds
  SceneId scene;                      ///< that the volumes light, as far as the server tells
  std::vector<ClientVolume> volumes;  ///< ascending by id; they may come and go

  [[nodiscard]] const ClientVolume* find(std::uint16_t id) const noexcept;  ///< null if none
};

/// Makes `to`, an earlier state of `from` or an empty frame, equal to it. Copies what changed only.
/// out_of_memory: `to` is as it was.
Status copy_changes(const ClientFrame& from, ClientFrame& to);

class Client;

/// Is told what a Client applied, e.g. a ClientRecorder.
class ClientListener {
 public:
  virtual ~ClientListener() = default;
  /// Within receive(), on its thread (a ClientThread's own), after an update that left the client
  /// consistent(): the packets that it brought, in their order, as they came. `client` must not be
  /// changed. Not called for a client that discards.
  virtual void updated(const Client& client,
                       std::span<const UpdateMessage::Part> packets) noexcept = 0;
};

struct ClientOptions {
  /// max_texture_bytes: of each texture; max_packet_bytes: of a message; max_total_bytes: of all
  /// that the client holds and a ClientThread copies, at its worst; max_work_bytes: of a message.
  DecodeLimits limits = {};
  std::vector<const Backend*> backends = {};  ///< besides the built-in ones; must outlive it
  std::vector<const Kind*> kinds = {};        ///< likewise
  Threads threads = {};                       ///< per packet
  Isa isa = best_isa();                       ///< kernels; the machine must have it
  /// If set, and set to true by any thread: receive() ends soon with Status::cancelled.
  const std::atomic<bool>* cancel = nullptr;
  Delivery delivery = Delivery::unicast;
  Budget budget = {};
  std::string token = {};
  /// False: textures of frames have no texels, for those who read() them to where they are needed.
  bool texels = true;
  /// Decodes nothing and acknowledges everything: for load tests. Its textures have no texels.
  bool discard = false;
  ClientListener* listener = nullptr;  ///< if set; must outlive the client
};

struct ClientStatistics {
  std::uint64_t messages = 0, bytes = 0;        ///< received, updates only
  std::uint64_t packets = 0, blocks = 0;        ///< decoded
  std::uint64_t gaps = 0;                       ///< times it missed something and asked for it
  std::uint64_t stale_messages = 0;             ///< of an earlier sync point, or repeated
  std::uint64_t proofs = 0, failed_proofs = 0;  ///< states compared with the server's
};

/// One thread at a time. Safe on hostile messages: each is applied, or leaves the last consistent
/// frame as it was.
class Client {
 public:
  /// invalid_settings for threads and isa, invalid_argument for other options out of range.
  [[nodiscard]] static Result<Client> create(const ClientOptions& options = {});
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;
  ~Client();

  /// The message that opens a connection; after a lost one it asks to go on with the session.
  [[nodiscard]] Result<Message> hello();
  /// Takes one message. unknown_kind: a volume is of a kind that is neither built in nor given.
  /// limit_exceeded also where it had to ask again by far more bytes than it received.
  /// After an error the connection is of no use: close it, and open another one if you like.
  /// Status::end after a Goodbye of the server. Missing and damaged updates are no errors, they are
  /// asked for again.
  Status receive(std::span<const std::byte> message);
  /// What to send after receive() and the calls below: acknowledgements, requests, interest. Moved
  /// out, oldest first.
  [[nodiscard]] std::vector<Message> take_messages();

  // Interest. It may come before there is a session, and is said again to every new one.
  /// Where it looks from, for servers that choose its blocks by that. invalid_argument for what is
  /// out of range, see Viewpoint.
  Status set_viewpoint(const Viewpoint& viewpoint);
  /// The blocks of a group that it wants, whatever it looks at, one byte each; empty for none of
  /// them. unknown_volume, unknown_group, mask_mismatch by the volumes of a session; what does not
  /// fit those of a new one is forgotten.
  Status subscribe(std::uint16_t volume, std::span<const std::uint8_t> blocks,
                   std::uint8_t group = 0);
  /// Ends the session, of which nothing is kept; send what take_messages() has, and close the
  /// connection. receive() answers Status::end until the next hello().
  Status disconnect();

  /// True once the server has answered hello().
  [[nodiscard]] bool is_connected() const noexcept;
  [[nodiscard]] bool resumed() const noexcept;  ///< the last hello() went on with a session
  /// The frame being built. While consistent() it is that of the last update; else something is
  /// missing in it and was asked for.
  [[nodiscard]] const ClientFrame& frame() const noexcept;
  [[nodiscard]] bool consistent() const noexcept;
  /// Writes the blocks of a texture that were replaced after the frame of that serial, guard bands
  /// included, to where they stand in `view`, e.g. mapped memory of a texture. While consistent()
  /// these are the contents of frame(). unknown_volume, unknown_texture, view_too_small.
  Status read(std::uint16_t volume, std::uint8_t texture, std::uint64_t since,
              TextureView view) const;
  /// What the server said when it ended the connection.
  [[nodiscard]] const Goodbye& goodbye() const noexcept;
  [[nodiscard]] const ClientStatistics& statistics() const noexcept;

 private:
  friend class ClientThread;
  friend class ClientRecorder;
  struct GICODEC_LOCAL State;
  explicit Client(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

/// A Client that decodes on a thread of its own and hands finished frames to a render loop. Each
/// function says which thread may call it; the network's and the renderer's may be the same one.
/// Left out of a library that is built with GICODEC_THREADS=OFF.
class ClientThread {
 public:
  struct Options {
    /// Received messages that wait for being decoded; limit_exceeded beyond.
    std::size_t max_waiting_bytes = std::size_t{256} << 20;
  };
  /// Takes the client, unless it answers out_of_memory: no memory, or no thread.
  [[nodiscard]] static Result<ClientThread> start(Client&& client, const Options& options);
  [[nodiscard]] static Result<ClientThread> start(Client&& client);
  ClientThread(ClientThread&&) noexcept;
  ClientThread& operator=(ClientThread&&) noexcept;
  /// Cancels the message being decoded.
  ~ClientThread();

  // Network thread.
  /// The message that opens a connection. Messages of the last connection are dropped first, the
  /// one being decoded is cancelled.
  [[nodiscard]] Result<Message> hello();
  Status push(Message message);
  [[nodiscard]] std::vector<Message> take_messages();
  /// The first error of Client::receive() since hello(), Status::end included; ok if none.
  [[nodiscard]] Status status() const;
  // As those of Client; none waits for what is being decoded, which disconnect() cancels.
  Status set_viewpoint(const Viewpoint& viewpoint);
  Status subscribe(std::uint16_t volume, std::span<const std::uint8_t> blocks,
                   std::uint8_t group = 0);
  Status disconnect();
  [[nodiscard]] Result<Goodbye> goodbye() const;  ///< out_of_memory
  [[nodiscard]] ClientStatistics statistics() const;
  /// True when nothing waits and nothing is being decoded.
  [[nodiscard]] bool idle() const;

  // Render thread.
  /// The newest finished frame: never waits, takes no lock. Valid until the next call. Its serial
  /// tells whether it is another one than before.
  [[nodiscard]] const ClientFrame& latest() noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit ClientThread(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
