// Streaming client (Stengel et al. §3.4) without a transport: takes messages of a server, holds the
// textures of its volumes.
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
  /// Per block, the ClientFrame::serial that last replaced it. 0: nothing was received for the
  /// place where the block stands now; do not shade with it.
  std::vector<std::uint64_t> changed;
  /// Largest error of the records, by the server's account, see TextureEntry; 0: lossless.
  float largest_error = 0;

  [[nodiscard]] ConstTextureView view() const noexcept { return {texels}; }
  /// Replaces `out` by the blocks that were replaced after the frame of serial `after_serial`,
  /// ascending. Keeps its capacity. out_of_memory.
  Status changed_blocks(std::uint64_t after_serial, std::vector<std::uint32_t>& out) const;
};

struct ClientVolume {
  std::uint16_t id = 0;  ///< the server's number of it; a later volume may get the same
  /// Counts the volumes that the client has had in all sessions. Unique: a renderer can identify
  /// its own textures by it.
  std::uint64_t instance = 0;
  std::string name;
  VolumeDesc desc;
  VolumeGeometry geometry;
  Grid region;                          ///< region size of shared streams
  std::vector<ClientTexture> textures;  ///< of all groups
};

/// The volumes after one update, all of the same moment.
struct ClientFrame {
  std::uint64_t epoch = 0;            ///< of the publisher: `update` and `time` belong to it
  std::uint64_t serial = 0;           ///< counts the updates applied; 0 before the first
  std::uint64_t began = 0;            ///< serial when the session began; all contents are newer
  std::uint64_t update = 0;           ///< the server's number of the update
  double time = 0;                    ///< of what the server shows, seconds
  SceneId scene;                      ///< that the volumes light; may be unknown
  std::vector<ClientVolume> volumes;  ///< ascending by id; they may come and go

  [[nodiscard]] const ClientVolume* find(std::uint16_t id) const noexcept;  ///< null if none
};

/// Makes `to`, an earlier state of `from` or an empty frame, equal to `from`. Copies only what
/// changed. out_of_memory leaves `to` as before.
Status copy_changes(const ClientFrame& from, ClientFrame& to);

class Client;

/// Gets the packets that a Client applied, e.g. for a ClientRecorder.
class ClientListener {
 public:
  virtual ~ClientListener() = default;
  /// receive() calls this after an update that left the client consistent(), on its own thread
  /// (that of a ClientThread). `packets`: those of the update, in order, as received. It must not
  /// change `client`. A client that discards does not call it.
  virtual void updated(const Client& client,
                       std::span<const UpdateMessage::Part> packets) noexcept = 0;
};

struct ClientOptions {
  /// max_texture_bytes: of each texture; max_packet_bytes and max_work_bytes: of each message;
  /// max_total_bytes: peak of all that the client holds and a ClientThread copies.
  DecodeLimits limits = {};
  std::vector<const Backend*> backends = {};  ///< besides the built-in ones; outlive the client
  std::vector<const Kind*> kinds = {};        ///< besides the built-in ones; outlive the client
  Threads threads = {};                       ///< per packet
  Isa isa = best_isa();                       ///< kernels; the machine must have it
  /// If set: once any thread makes it true, receive() soon fails with Status::cancelled.
  const std::atomic<bool>* cancel = nullptr;
  Delivery delivery = Delivery::unicast;
  Budget budget = {};
  std::string token = {};
  /// False: textures of frames have no texels; the caller gets them by read().
  bool texels = true;
  /// True, for load tests: decodes nothing, acknowledges everything. Textures have no texels.
  bool discard = false;
  ClientListener* listener = nullptr;  ///< if set; must outlive the client
};

struct ClientStatistics {
  std::uint64_t messages = 0, bytes = 0;        ///< received, updates only
  std::uint64_t packets = 0, blocks = 0;        ///< decoded
  std::uint64_t gaps = 0;                       ///< times it missed an update and sent a Resync
  std::uint64_t stale_messages = 0;             ///< of an earlier sync point, or repeated
  std::uint64_t proofs = 0, failed_proofs = 0;  ///< states compared with the server's
};

/// One thread at a time. Safe on hostile messages. An update that cannot be applied in full may
/// leave frame() half changed: it is not consistent() until the server has sent what is missing.
/// ClientThread::latest() stays the last consistent frame.
class Client {
 public:
  /// invalid_settings (threads, isa); invalid_argument (other options out of range).
  [[nodiscard]] static Result<Client> create(const ClientOptions& options = {});
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;
  ~Client();

  /// The message that opens a connection. After a lost connection it asks to continue the session.
  /// The client has no clock: if it is not is_connected() some seconds after you sent the message,
  /// or messages cease to come, close the connection, open another one, and call this again.
  [[nodiscard]] Result<Message> hello();
  /// Takes one message. Status::end after a Goodbye of the server. Missing and damaged updates are
  /// no errors: the client requests what it lacks. After an error close the connection.
  /// unknown_kind: a volume's kind is neither built in nor in ClientOptions. limit_exceeded: also
  /// if the client's requests take far more bytes than the server sends.
  Status receive(std::span<const std::byte> message);
  /// Moves out the messages to send after receive() and the calls below, oldest first.
  [[nodiscard]] std::vector<Message> take_messages();

  // Interest. May be set before there is a session; the client sends it to every new session.
  /// Sets the camera, by which a server may choose blocks. invalid_argument if out of range, see
  /// Viewpoint.
  Status set_viewpoint(const Viewpoint& viewpoint);
  /// Chooses the blocks of a group, whatever the viewpoint: one byte each, 0 for unwanted; empty:
  /// none. In a session: unknown_volume, unknown_group, mask_mismatch. Without one, a choice that
  /// does not fit the volumes of the next session is dropped.
  Status subscribe(std::uint16_t volume, std::span<const std::uint8_t> blocks,
                   std::uint8_t group = 0);
  /// Ends the session for good. Send take_messages(), then close the connection. receive() answers
  /// Status::end until the next hello().
  Status disconnect();

  /// True once the server has answered hello().
  [[nodiscard]] bool is_connected() const noexcept;
  [[nodiscard]] bool resumed() const noexcept;  ///< the last hello() continued a session
  /// The frame being built: complete while consistent(), else something is missing and requested.
  [[nodiscard]] const ClientFrame& frame() const noexcept;
  [[nodiscard]] bool consistent() const noexcept;
  /// Writes the blocks of a texture that were replaced after the frame of serial `after_serial`,
  /// guard bands included, to their places in `view`, e.g. mapped memory. While consistent() these
  /// are the contents of frame(). unknown_volume, unknown_texture, view_too_small.
  Status read(std::uint16_t volume, std::uint8_t texture, std::uint64_t after_serial,
              TextureView view) const;
  /// The server's reason for ending the connection.
  [[nodiscard]] const Goodbye& goodbye() const noexcept;
  [[nodiscard]] const ClientStatistics& statistics() const noexcept;

 private:
  friend class ClientThread;
  friend class ClientRecorder;
  struct GICODEC_LOCAL State;
  explicit Client(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

/// A Client that decodes on a thread of its own and gives finished frames to a render loop. The
/// network thread and the render thread below may be the same. A library that is built with
/// GICODEC_THREADS=OFF does not have it.
class ClientThread {
 public:
  struct Options {
    /// Bytes of received messages in the queue; push() answers limit_exceeded beyond.
    std::size_t max_waiting_bytes = std::size_t{256} << 20;
  };
  /// Moves from `client`, except after out_of_memory: no memory, or no thread.
  [[nodiscard]] static Result<ClientThread> start(Client&& client, const Options& options);
  [[nodiscard]] static Result<ClientThread> start(Client&& client);
  ClientThread(ClientThread&&) noexcept;
  ClientThread& operator=(ClientThread&&) noexcept;
  /// Cancels the message being decoded.
  ~ClientThread();

  // Network thread.
  /// As Client::hello(). Drops queued messages of the last connection and cancels the one being
  /// decoded.
  [[nodiscard]] Result<Message> hello();
  /// Queues a received message.
  Status push(Message message);
  [[nodiscard]] std::vector<Message> take_messages();
  /// The first error of Client::receive() since hello(), Status::end included; ok if none.
  [[nodiscard]] Status status() const;
  // As in Client. None waits for decoding; disconnect() cancels it.
  Status set_viewpoint(const Viewpoint& viewpoint);
  Status subscribe(std::uint16_t volume, std::span<const std::uint8_t> blocks,
                   std::uint8_t group = 0);
  Status disconnect();
  [[nodiscard]] Result<Goodbye> goodbye() const;  ///< out_of_memory
  [[nodiscard]] ClientStatistics statistics() const;
  /// True if the queue is empty and nothing is being decoded.
  [[nodiscard]] bool idle() const;

  // Render thread.
  /// The newest finished frame, without waiting or locking. Valid until the next call. A frame with
  /// another serial is a new one.
  [[nodiscard]] const ClientFrame& latest() noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit ClientThread(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
