// What a Distributor is made of. distributor.cpp answers its calls; distributor_unicast.cpp and
// distributor_shared.cpp make the packets of the two kinds of delivery.
#pragma once

#include "session/server/distributor.h"
#include "session/server/priority.h"
#include "session/server/served_volume.h"
#include "session/server/shared_rate.h"

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

namespace gicodec {

/// What one thread needs to write packets of one description.
struct StreamWorker {
  TextureDesc desc;
  std::unique_ptr<BackendEncoder> encoder;
  PacketWriter writer = {};
};

/// Where a texture is served.
struct TexturePlace {
  Lot* lot = nullptr;
  std::size_t lot_id = 0;  ///< in the volume
  std::size_t place = 0;   ///< in the lot
};

/// Blocks of a volume's groups; empty: nothing.
using Masks = std::vector<BlockMask>;

/// A client's own chains of a lot.
struct OwnLot {
  ServedVolume* volume;
  Lot* lot;
  std::vector<UpdateStream> streams;      ///< by texture
  std::vector<std::uint32_t> owed_since;  ///< update in which a block became owed; 0 if not
  std::vector<std::unique_ptr<BackendEncoder>> encoders;  ///< only where the backend remembers

  /// The last update with the contents that the client holds of a block; 0: it holds none.
  [[nodiscard]] std::uint32_t until(std::uint32_t block, std::uint64_t update) const noexcept;
};

/// A client's part in a region, and what it holds of one texture.
struct Join {
  bool subscribed = false;
  std::uint32_t sequence = 0, checksum = 0;
  std::uint32_t since = 0;  ///< the first update after it subscribed
};

/// What a client was owed longest when all its blocks were looked at last. While enough of it is
/// left, nothing else can be owed longer.
struct Backlog {
  std::uint64_t update = 0;  ///< when that was
  BlockMask due;             ///< lots that were, by place in ServedClient::own
  struct Place {
    std::uint32_t lot, block;
  };
  std::vector<Place> oldest;  ///< in order of lot and block
  std::size_t others = 0;     ///< blocks that were owed besides these
};

struct ServedClient {
  explicit ServedClient(ClientId id) : rate(id) {}
  Delivery delivery = Delivery::unicast;
  Budget budget;
  bool suspended = false;
  std::vector<Masks> visible;  ///< by volume
  /// Own: the same with what visible blocks name, if any do; null: not known yet.
  std::vector<std::shared_ptr<const Masks>> wanted;
  std::vector<OwnLot> own;  ///< Delivery::unicast: by volume and lot
  Backlog backlog;          ///< own
  /// Shared: by volume and lot; per region and texture.
  std::vector<std::vector<std::vector<Join>>> joins;
  float bytes_per_block = 0;    ///< own: of late; 0 before the first packet
  SharedRate rate;              ///< shared
  std::uint64_t written = 0;    ///< own: blocks in the packets of the last update
  std::uint64_t looked_at = 0;  ///< own: blocks, to choose these
  bool held_back = false;       ///< for want of bytes something is missing
  bool owed = true;             ///< own: anything, when it was looked at last
  std::vector<OutgoingPacket> out;
  ClientState totals;

  [[nodiscard]] bool knows_wanted(const OwnLot& of) const noexcept {
    return !of.volume->linked || wanted[of.volume->id()] != nullptr;
  }
  /// Precondition: knows_wanted(of).
  [[nodiscard]] const BlockMask& wants(const OwnLot& of) const noexcept {
    const std::uint16_t id = of.volume->id();
    return (of.volume->linked ? *wanted[id] : visible[id])[of.lot->group_id];
  }
  /// The joins of a region of a lot, one per texture.
  [[nodiscard]] std::span<Join> joins_of(std::uint16_t volume, std::size_t lot_id, const Lot& lot,
                                         std::uint32_t region) noexcept {
    const std::size_t textures = lot.textures.size();
    return std::span(joins[volume][lot_id]).subspan(region * textures, textures);
  }
};

/// The chosen blocks of an own lot, and their packets, by texture.
struct Planned {
  std::uint32_t lot;  ///< place in ServedClient::own
  std::vector<std::uint32_t> blocks = {};
  std::vector<Written> written = {};
};

/// n · k, or the largest number.
[[nodiscard]] constexpr std::size_t times(std::size_t n, std::size_t k) noexcept {
  return n > SIZE_MAX / k ? SIZE_MAX : n * k;
}

/// What a client wants of all due lots and does not hold as it is.
struct Owed {
  std::vector<Candidate> candidates;  ///< in order of lot and block
  std::size_t blocks = 0;             ///< of all of it, whether it is among these or not
};
/// With the `most` candidates that are owed longest at least, and all where more than age counts.
/// All blocks are looked at only where the backlog does not have as many.
[[nodiscard]] Owed collect(ServedClient& client, std::uint64_t update, std::size_t most);
/// Whether a client that wants these blocks of a lot lacks one of them as it is.
[[nodiscard]] bool is_owed(const OwnLot& own, const BlockMask& wanted,
                           std::uint32_t block) noexcept;
/// By rank where the kind has one, else by the share of the block that changed.
void weigh(const ServedClient& client, std::span<Candidate> candidates);
/// What a candidate names and the client has not held since the candidate is owed.
[[nodiscard]] std::vector<Candidate> lacking(ServedClient& client, const Candidate& naming,
                                             std::uint64_t update);

/// What one publish() looks at, kept for its capacity.
struct Reading {
  Status choose(const BlockMask& unread, std::span<const std::uint32_t> listed);

  std::vector<std::uint32_t> all, blocks;
  BlockMask read, seen;
  std::vector<std::byte> presence;
  std::vector<BlockId> before;
};

struct Distributor::State {
  Result<StreamWorker*> worker(unsigned thread, const TextureDesc& desc);
  Status add_texture(ServedVolume& volume, std::uint8_t group_id, const NamedTexture& texture,
                     const StreamedTexture& streamed);
  Status add_lots(ServedVolume& volume, std::span<const StreamedTexture> options);
  Status add_volume_to(ServedClient& client, ServedVolume& volume);
  static void drop_volume_of(ServedClient& client, const ServedVolume& volume) noexcept;
  [[nodiscard]] bool any_shared() const noexcept;
  void forget_wanted(const ServedVolume& volume) noexcept;
  void refresh_names();
  void refresh_wanted();
  [[nodiscard]] TexturePlace find(std::uint16_t volume, std::uint8_t texture) const noexcept;
  /// Null if there is none of that number.
  [[nodiscard]] ServedVolume* find_volume(std::uint16_t volume) const noexcept {
    const bool there = volume < volumes.size() && !volumes[volume]->removed();
    return there ? volumes[volume].get() : nullptr;
  }
  /// unknown_volume, unknown_group, mask_mismatch.
  [[nodiscard]] Status check_mask(std::uint16_t volume, std::uint8_t group,
                                  std::span<const std::uint8_t> mask) const noexcept;
  Status update_own(ServedClient& client, unsigned thread);
  Status write_within_budget(ServedClient& client, unsigned thread, std::vector<Planned>& planned,
                             std::size_t& sent);
  Status write_own(ServedClient& client, unsigned thread, std::span<Planned> planned);
  Status update_region(ServedVolume& volume, Lot& lot, std::uint32_t region, unsigned thread);
  template <typename Visit>
  void for_each_region(const Visit& visit) const {
    for (const auto& volume : volumes) {
      for (const auto& lot : volume->lots) {
        for (SharedRegion& shared : lot->regions) visit(*volume, *lot, shared);
      }
    }
  }
  template <typename Visit>
  void for_each_join(ServedClient& client, const Visit& visit) noexcept;
  void gather_audiences() noexcept;
  void allot_extras() noexcept;
  [[nodiscard]] std::vector<std::uint32_t> outdated_blocks(const ServedVolume& volume,
                                                           const Lot& lot,
                                                           const SharedRegion& shared) const;
  Status advance(const ServedVolume& volume, const Lot& lot, SharedRegion& shared, unsigned thread);
  Status write(const Lot& lot, SharedRegion& shared, const Behind* from,
               const std::vector<std::uint32_t>* next, unsigned thread,
               std::vector<Written>& written, Audience& audience);
  Status hand_out_regions(ServedClient& client) noexcept;
  [[nodiscard]] bool holds_all_named(ServedClient& client, const ServedVolume& volume,
                                     const Lot& lot, const SharedRegion& naming,
                                     std::span<const Join> joins) const noexcept;
  void forget_audiences() noexcept;
  void set_joins(ServedClient& client, const ServedVolume& volume) noexcept;
  [[nodiscard]] ServedClient* find(ClientId client);
  [[nodiscard]] UpdateStream* find(ServedClient& client, StreamId id);
  /// The joins of a region, one per texture; none if there is no such region.
  [[nodiscard]] std::span<Join> find_joins(ServedClient& client, StreamId id) const noexcept;
  /// What the client holds of a region; null if that is not known.
  [[nodiscard]] const StreamState* held_of_region(ServedClient& client, StreamId id) const noexcept;

  DistributorOptions options;
  const Backend* backend = nullptr;
  Reading reading;
  bool remembers = false;  ///< as its encoders say
  std::vector<std::unique_ptr<ServedVolume>> volumes;
  std::map<ClientId, std::unique_ptr<ServedClient>> clients;
  ClientId next_client = 1;
  std::uint64_t updates = 0;
  std::uint32_t extra_blocks = 0;                                   ///< 0: no limit
  std::vector<std::vector<std::unique_ptr<StreamWorker>>> workers;  ///< by thread
};

}  // namespace gicodec
