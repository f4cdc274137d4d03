// What a Server is made of. server.cpp answers its calls; server_own.cpp and server_shared.cpp make
// the packets of the two kinds of delivery.
#pragma once

#include <gicodec/server.h>

#include "session/block_history.h"
#include "session/priority.h"
#include "session/shared_rate.h"
#include "session/update_stream.h"

#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace gicodec {

/// What one thread needs to write packets of one description.
struct StreamWorker {
  StreamWorker(const TextureDesc& desc, std::unique_ptr<BackendEncoder> own)
      : scratch(desc), encoder(std::move(own)) {}
  StreamScratch scratch;
  std::unique_ptr<BackendEncoder> encoder;
};

struct SharedPacket {
  std::shared_ptr<const Packet> packet;
  std::uint32_t probes = 0;
};

/// Clients of a chunk that hold the same of it.
struct Audience {
  std::uint32_t all = 0;
  std::uint32_t served = 0;           ///< those of them whose turn this update is
  bool extra = false;                 ///< packets are made only for them, and there is time for it
  std::vector<SharedPacket> packets;  ///< that take them to the stream's state
};

/// What some clients of a chunk hold, who missed what came after.
struct Behind {
  StreamState state;
  Audience audience;
};

/// A chunk of one texture: the stream that all subscribers share. Those who take fewer updates than
/// others hold an earlier state of it and are sent what they lack of the present one.
struct ChunkStream {
  explicit ChunkStream(UpdateStream own) : stream(std::move(own)) {}
  UpdateStream stream;
  std::vector<Behind> behind;  ///< in the order of their sequences
  std::uint64_t written = 0;   ///< probes in the packets of the last update
  Audience up_to_date;         ///< who hold the stream's state
  Audience waiting;            ///< who hold nothing that is known
};

struct ServedTexture {
  ServedTexture(const StreamedTexture& options_in, std::uint8_t id_in, Isa isa)
      : options(options_in), id(id_in), history(options_in.desc, isa) {}

  [[nodiscard]] bool due(std::uint64_t update) const noexcept {
    return update % options.interval == 0;
  }
  /// True if what a receiver of `stream` holds of a probe is to be replaced.
  [[nodiscard]] bool outdated(const UpdateStream& stream, std::uint32_t probe) const noexcept;

  StreamedTexture options;
  std::uint8_t id;
  BlockHistory history;
  std::vector<ChunkStream> chunks;
};

struct ServedVolume {
  std::uint16_t id = 0;
  VolumeGeometry geometry;
  ProbeMask active;  ///< empty: all
  ChunkGrid chunks;
  std::vector<std::vector<std::uint32_t>> chunk_probes;
  std::vector<std::unique_ptr<ServedTexture>> textures;

  [[nodiscard]] bool is_active(std::uint32_t probe) const noexcept {
    return active.empty() || active[probe] != 0;
  }
};

/// A client's own chain of one texture.
struct OwnStream {
  ServedVolume* volume;
  ServedTexture* texture;
  UpdateStream stream;
  std::vector<std::uint32_t> owed_since;    ///< update in which a probe became owed; 0 if not
  std::unique_ptr<BackendEncoder> encoder;  ///< only where the backend remembers
};

/// A client's part in a shared chunk, and what it holds of it.
struct Join {
  bool subscribed = false;
  std::uint32_t sequence = 0, checksum = 0;
};

struct ServedClient {
  explicit ServedClient(ClientId id) : rate(id) {}
  Delivery delivery = Delivery::own;
  Budget budget;
  bool suspended = false;
  std::vector<ProbeMask> visible;        ///< by volume; empty: nothing
  std::vector<OwnStream> own;            ///< Delivery::own: by volume and texture
  std::vector<std::vector<Join>> joins;  ///< shared: by volume; per chunk and texture
  float bytes_per_probe = 0;             ///< own: of late; 0 before the first packet
  SharedRate rate;                       ///< shared
  std::uint64_t written = 0;             ///< own: probes in the packets of the last update
  bool held_back = false;                ///< for want of bytes something is missing
  std::vector<OutgoingPacket> out;
  ClientState totals;
};

/// The chosen probes of an own stream, and their packets.
struct Planned {
  std::uint32_t stream;  ///< place in ServedClient::own
  std::vector<std::uint32_t> probes;
  std::vector<WrittenPacket> packets;
};

struct Server::State {
  Result<StreamWorker*> worker(unsigned thread, const TextureDesc& desc);
  Status add_volume_to(ServedClient& client, ServedVolume& volume);
  void drop_last_volume_of(ServedClient& client) noexcept;
  [[nodiscard]] bool any_shared() const noexcept;
  Status update_own(ServedClient& client, unsigned thread);
  Status write_within_budget(ServedClient& client, unsigned thread,
                             std::vector<Candidate>& candidates, std::vector<Planned>& planned);
  Status write_own(ServedClient& client, unsigned thread, std::span<Planned> planned);
  Status update_chunk(ServedVolume& volume, ServedTexture& texture, std::uint32_t chunk,
                      unsigned thread);
  template <typename Visit>
  void for_each_join(ServedClient& client, const Visit& visit) noexcept;
  void gather_audiences() noexcept;
  void allot_extras() noexcept;
  Status advance(const ServedVolume& volume, const ServedTexture& texture, ChunkStream& shared,
                 StreamWorker& with);
  Status make_skip(ChunkStream& shared, Behind& behind, StreamWorker& with);
  Status make_snapshot(ChunkStream& shared, StreamWorker& with);
  Status hand_out_chunks(ServedClient& client) noexcept;
  void forget_behind() noexcept;
  void set_joins(ServedClient& client, const ServedVolume& volume) noexcept;
  Status resume_chunk(ServedClient& client, StreamId id, std::uint32_t sequence,
                      std::uint32_t checksum);
  [[nodiscard]] ServedClient* find(ClientId client);
  [[nodiscard]] OwnStream* find(ServedClient& client, StreamId id);
  /// Nulls if there is no such chunk.
  [[nodiscard]] std::pair<Join*, ChunkStream*> find_chunk(ServedClient& client, StreamId id);
  /// What the client holds of a chunk; null if that is not known.
  [[nodiscard]] const StreamState* held_of_chunk(ServedClient& client, StreamId id);

  ServerOptions options;
  const Backend* backend = nullptr;
  bool remembers = false;  ///< as its encoders say
  std::vector<std::unique_ptr<ServedVolume>> volumes;
  std::map<ClientId, std::unique_ptr<ServedClient>> clients;
  ClientId next_client = 1;
  std::uint64_t updates = 0;
  std::uint32_t extra_probes = 0;                                   ///< 0: no limit
  std::vector<std::vector<std::unique_ptr<StreamWorker>>> workers;  ///< by thread
};

}  // namespace gicodec
