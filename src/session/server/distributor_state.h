// The state of a Distributor. distributor.cpp publishes and updates; _clients and _volumes have the
// other calls; _interest finds pending blocks; _presets chooses presets; _unicast and _regions
// write packets; _shared counts subscribers and hands packets of regions out.
#pragma once

#include "session/server/distributor.h"
#include "session/server/preset_choice.h"
#include "session/server/priority.h"
#include "session/server/served_volume.h"
#include "session/server/shared_rate.h"

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

namespace gicodec {

/// What one thread needs to write packets.
struct StreamWorker {
  struct Stateless {
    const ServedTexture* texture;  ///< null: of any with the server's backend
    TextureDesc desc;
    std::unique_ptr<BackendEncoder> encoder;
  };
  std::vector<Stateless> encoders = {};
  PacketWriter writer = {};
};

/// Where a texture is: its bundle, and its place there.
struct TexturePlace {
  Bundle* bundle = nullptr;
  std::size_t bundle_id = 0;  ///< in the volume
  std::size_t place = 0;      ///< in the bundle
};

/// Blocks of a volume's groups; empty: nothing.
using Masks = std::vector<BlockMask>;

/// A unicast client's chains of a bundle.
struct UnicastBundle {
  ServedVolume* volume;
  Bundle* bundle;
  std::vector<UpdateStream> streams;         ///< by texture
  std::vector<std::uint32_t> pending_since;  ///< update since which a block is pending; 0 if not
  /// By texture, null where the backend is not stateful.
  std::vector<std::unique_ptr<BackendEncoder>> encoders = {};

  /// The last update with the contents that the client holds of a block; 0: it holds none.
  [[nodiscard]] std::uint32_t last_current(std::uint32_t block,
                                           std::uint64_t update) const noexcept;
};

/// A client's subscription to a region, and what it holds of one texture of it.
struct Subscription {
  bool subscribed = false;
  bool owed = false;  ///< its turn came while it waited for a keyframe of a stateful backend
  std::uint32_t sequence = 0, checksum = 0;
  std::uint32_t first_update = 0;  ///< after it subscribed
};

/// The blocks that were pending longest for a client when all its blocks were last examined. While
/// enough of these are left, no other block can be pending longer.
struct Backlog {
  std::uint64_t update = 0;  ///< when all blocks were examined
  BlockMask due;             ///< bundles that were due, by place in ServedClient::unicast
  struct Place {
    std::uint32_t bundle, block;
  };
  std::vector<Place> oldest;  ///< in order of bundle and block
  std::size_t others = 0;     ///< further pending blocks
};

struct ServedClient {
  explicit ServedClient(ClientId id) : rate(id) {}
  Delivery delivery = Delivery::unicast;
  Budget budget;
  bool suspended = false;
  std::vector<Masks> visible;  ///< by volume
  /// Unicast: visible blocks and what these depend on; null: not known yet.
  std::vector<std::shared_ptr<const Masks>> interest;
  std::vector<UnicastBundle> unicast;  ///< Delivery::unicast: by volume and bundle
  Backlog backlog;                     ///< unicast
  /// Shared: by volume and bundle; per region and texture.
  std::vector<std::vector<std::vector<Subscription>>> subscriptions;
  float bytes_per_block = 0;   ///< unicast: recent mean; 0 before the first packet
  SharedRate rate;             ///< shared
  double throughput = 0;       ///< see Distributor::set_throughput()
  PresetChoice preset;         ///< unicast
  PresetCosts costs;           ///< unicast: of the packets of the last update
  std::uint64_t written = 0;   ///< unicast: blocks in the packets of the last update
  std::uint64_t examined = 0;  ///< unicast: blocks examined to choose these
  bool held_back = false;      ///< see Distributor::held_back()
  bool has_pending = true;     ///< unicast: see Distributor::has_pending()
  std::vector<OutgoingPacket> out;
  ClientState totals;

  [[nodiscard]] bool knows_interest(const UnicastBundle& of) const noexcept {
    return !of.volume->linked || interest[of.volume->id()] != nullptr;
  }
  /// Precondition: knows_interest(of).
  [[nodiscard]] const BlockMask& interest_in(const UnicastBundle& of) const noexcept {
    const std::uint16_t id = of.volume->id();
    return (of.volume->linked ? *interest[id] : visible[id])[of.bundle->group_id];
  }
  /// The subscriptions of a region of a bundle, one per texture.
  [[nodiscard]] std::span<Subscription> subscriptions_of(std::uint16_t volume,
                                                         std::size_t bundle_id,
                                                         const Bundle& bundle,
                                                         std::uint32_t region) noexcept {
    const std::size_t textures = bundle.textures.size();
    return std::span(subscriptions[volume][bundle_id]).subspan(region * textures, textures);
  }
};

/// The chosen blocks of a unicast bundle, and their packets, by texture.
struct Planned {
  std::uint32_t bundle;  ///< place in ServedClient::unicast
  std::vector<std::uint32_t> blocks = {};
  std::vector<Written> written = {};
};

/// n · k, or the largest number.
[[nodiscard]] constexpr std::size_t times(std::size_t n, std::size_t k) noexcept {
  return n > SIZE_MAX / k ? SIZE_MAX : n * k;
}

/// The pending blocks of a client in all due bundles.
struct PendingBlocks {
  std::vector<Candidate> candidates;  ///< in order of bundle and block
  std::size_t blocks = 0;             ///< all pending blocks, candidates or not
};
/// Returns at least the `most` candidates that are pending longest, and all candidates if not only
/// age counts. Examines all blocks only if the backlog has too few.
[[nodiscard]] PendingBlocks collect(ServedClient& client, std::uint64_t update, std::size_t most);
/// True if the client with this interest in a bundle does not hold the block's current contents.
[[nodiscard]] bool is_pending(const UnicastBundle& unicast, const BlockMask& interest,
                              std::uint32_t block) noexcept;
/// Sets the weights: the rank where the kind has one, else the share of the block that changed.
void weigh(const ServedClient& client, std::span<Candidate> candidates);
/// Blocks that a candidate depends on and the client has not held since the candidate is pending.
[[nodiscard]] std::vector<Candidate> missing_dependencies(ServedClient& client,
                                                          const Candidate& dependent,
                                                          std::uint64_t update);

/// The blocks that one publish() reads; an object is reused for its capacity.
struct Reading {
  Status choose(const BlockMask& unread, std::span<const std::uint32_t> listed);

  std::vector<std::uint32_t> all, blocks;
  BlockMask read, seen;
  std::vector<std::byte> presence;
  std::vector<BlockId> before;
};

struct Distributor::State {
  /// The encoder of a stream, set to `preset` if the texture has a choice: its own, or the thread's
  /// if that is null.
  Result<BackendEncoder*> encoder(unsigned thread, const ServedTexture& texture,
                                  const UpdateStream& stream, BackendEncoder* own,
                                  std::size_t preset);
  Status make_encoders(const Bundle& bundle, std::span<const UpdateStream> streams,
                       std::vector<std::unique_ptr<BackendEncoder>>& out) const;
  /// The options of each texture, by texture id.
  [[nodiscard]] Result<std::vector<TextureOptions>> texture_options(
      const VolumeDesc& volume, std::span<const StreamedTexture> streamed) const;
  Status add_texture(ServedVolume& volume, std::uint8_t group_id, const NamedTexture& texture,
                     TextureOptions settings);
  Status add_bundles(ServedVolume& volume, std::span<const TextureOptions> textures);
  Status add_volume_to(ServedClient& client, ServedVolume& volume);
  static void drop_volume_of(ServedClient& client, const ServedVolume& volume) noexcept;
  [[nodiscard]] bool any_unicast() const noexcept;
  void forget_interest(const ServedVolume& volume) noexcept;
  void refresh_dependencies();
  void refresh_interest();
  [[nodiscard]] TexturePlace find(std::uint16_t volume, std::uint8_t texture) const noexcept;
  /// Null if there is none of that number.
  [[nodiscard]] ServedVolume* find_volume(std::uint16_t volume) const noexcept {
    const bool there = volume < volumes.size() && !volumes[volume]->removed();
    return there ? volumes[volume].get() : nullptr;
  }
  /// unknown_volume, unknown_group, mask_mismatch.
  [[nodiscard]] Status check_mask(std::uint16_t volume, std::uint8_t group,
                                  std::span<const std::uint8_t> mask) const noexcept;
  Status update_unicast(ServedClient& client, unsigned thread);
  Status write_within_budget(ServedClient& client, unsigned thread, std::vector<Planned>& planned,
                             std::size_t& sent);
  Status write_unicast(ServedClient& client, unsigned thread, std::span<Planned> planned);
  Status update_region(ServedVolume& volume, Bundle& bundle, std::uint32_t region, unsigned thread);
  template <typename Visit>
  void for_each_region(const Visit& visit) const {
    for (const auto& volume : volumes) {
      for (const auto& bundle : volume->bundles) {
        for (SharedRegion& shared : bundle->regions) visit(*volume, *bundle, shared);
      }
    }
  }
  template <typename Visit>
  void for_each_subscription(ServedClient& client, const Visit& visit) noexcept;
  void choose_presets();
  [[nodiscard]] bool chooses_presets() const noexcept;  ///< of some texture
  void gather_subscribers() noexcept;
  void allot_catch_ups() noexcept;
  [[nodiscard]] std::vector<std::uint32_t> outdated_blocks(const ServedVolume& volume,
                                                           const Bundle& bundle,
                                                           const SharedRegion& shared) const;
  Status advance(const ServedVolume& volume, const Bundle& bundle, SharedRegion& shared,
                 unsigned thread);
  Status write(const Bundle& bundle, SharedRegion& shared, const Lagging* from,
               const std::vector<std::uint32_t>* next, unsigned thread,
               std::vector<Written>& written, SubscriberGroup& subscribers);
  Status hand_out_regions(ServedClient& client) noexcept;
  [[nodiscard]] bool takes_part(const ServedClient& client, const Bundle& bundle, std::size_t place,
                                std::span<const Subscription> subscriptions) const noexcept;
  [[nodiscard]] bool holds_dependencies(ServedClient& client, const ServedVolume& volume,
                                        const Bundle& bundle, const SharedRegion& dependent,
                                        std::span<const Subscription> subscriptions) const noexcept;
  void forget_subscribers() noexcept;
  void set_joins(ServedClient& client, const ServedVolume& volume) noexcept;
  [[nodiscard]] ServedClient* find(ClientId client);
  [[nodiscard]] UpdateStream* find(ServedClient& client, StreamId id);
  /// The subscriptions of a region, one per texture; none if there is no such region.
  [[nodiscard]] std::span<Subscription> find_subscriptions(ServedClient& client,
                                                           StreamId id) const noexcept;
  /// What the client holds of a region; null if that is not known.
  [[nodiscard]] const StreamState* held_of_region(ServedClient& client, StreamId id) const noexcept;

  DistributorOptions options;
  const Backend* backend = nullptr;
  Reading reading;
  std::vector<std::unique_ptr<ServedVolume>> volumes;
  std::map<ClientId, std::unique_ptr<ServedClient>> clients;
  ClientId next_client = 1;
  std::uint64_t updates = 0;
  std::uint32_t limit_for_few = 0;  ///< 0: no limit
  ProcessorTime time;
  /// PresetCosts::kPublished of what was published since the last update, and before it.
  double published_seconds = 0, updated_seconds = 0;
  PresetChoice shared_preset;         ///< of the packets of regions
  std::uint32_t shared_clients = 0;   ///< that are not suspended
  std::vector<double> throughputs;    ///< of these
  std::vector<StreamWorker> workers;  ///< by thread
};

}  // namespace gicodec
