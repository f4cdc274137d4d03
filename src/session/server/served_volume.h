// Served volume: a volume as the server holds it, with its description for clients, the published
// contents of its textures, and the streams of its regions.
#pragma once

#include <gicodec/protocol.h>

#include "session/server/preset_choice.h"
#include "session/server/priority.h"
#include "stream/block_history.h"
#include "stream/packet_writer.h"
#include "stream/update_stream.h"

#include <memory>
#include <vector>

namespace gicodec {

struct SharedPacket {
  std::uint8_t texture = 0;  ///< of the volume
  std::uint32_t sequence = 0;
  bool keyframe = false;
  std::shared_ptr<const Packet> packet;
  std::uint32_t blocks = 0;
};

/// Clients of a region that hold the same state of it.
struct SubscriberGroup {
  std::uint32_t all = 0;
  std::uint32_t served = 0;           ///< those whose turn this update is
  bool allotted = false;              ///< the update has time for packets for these only
  std::vector<SharedPacket> packets;  ///< that take them to the streams' state
};

/// An earlier state of a region that some clients hold: one state per texture.
struct Lagging {
  std::vector<StreamState> states;
  std::uint32_t last_current = 0;  ///< SharedRegion::last_current() of that state
  SubscriberGroup subscribers;
};

/// A region of a bundle: the streams, one per texture, that all subscribers share. Clients that get
/// fewer updates hold an earlier state of the streams and get catch-ups.
struct SharedRegion {
  std::vector<UpdateStream> streams;
  std::vector<std::unique_ptr<BackendEncoder>> encoders;  ///< as UnicastBundle::encoders
  std::uint64_t keyframe_turn = 0;  ///< where they are stateful: of the last keyframe; 0: none yet
  std::size_t bytes = 0;            ///< of its blocks in all textures
  std::vector<Lagging> lagging;     ///< in the order of their sequences
  std::uint64_t written = 0;        ///< blocks in the packets of the last update
  std::uint64_t written_for_few = 0;  ///< of these, in packets for few clients
  PresetCosts costs = {};             ///< of the packets of the last update
  SubscriberGroup up_to_date;         ///< hold the streams' state
  SubscriberGroup waiting;            ///< hold no known state
  // Where blocks depend on others:
  /// The first update in which current contents differ from the streams'; 0: they do not differ.
  std::uint32_t changed = 0;
  bool dependencies_changed = false;  ///< `dependencies` has more than the current ones
  std::vector<std::uint32_t>
      dependencies;  ///< regions that the streams' blocks depend on, ascending

  /// The last update with the contents that the streams hold.
  [[nodiscard]] std::uint32_t last_current(std::uint64_t update) const noexcept {
    return changed == 0 ? static_cast<std::uint32_t>(update) : changed - 1;
  }
};

/// How a texture is sent, with the backend and what its encoder says of itself.
struct TextureOptions : StreamedTexture {
  bool own_backend = false;  ///< not the server's
  bool is_stateful = false, is_lossy = false;
  bool chooses_preset = false;  ///< native, without a preset of the application's
};

struct ServedTexture {
  ServedTexture(const NamedTexture& texture, const TextureOptions& options_in, std::uint8_t id_in,
                Isa isa, const Threads& threads)
      : options(options_in),
        id(id_in),
        history(texture.desc, isa, BlockHistory::Use::server, threads, options_in.max_error),
        rule(texture.threshold),
        unread(block_count(texture.desc), 1) {}

  /// True if the block entered by scrolling and was not read since: its contents belong to its
  /// former place.
  [[nodiscard]] bool waits(std::uint32_t block) const noexcept {
    return published && unread[block] != 0;
  }
  /// True if a client of `stream` does not hold the block's current contents.
  [[nodiscard]] bool outdated(const UpdateStream& stream, std::uint32_t block) const noexcept;

  TextureOptions options;
  std::uint8_t id;  ///< in the volume
  BlockHistory history;
  Threshold rule;
  bool published = false;
  bool presence_changed = false;  ///< since it was published
  /// Blocks that the next publish() reads, listed or not: those never read, scrolled in, or with
  /// another presence.
  BlockMask unread;
  /// Where blocks depend on others: by version, the last update in which it was current.
  std::vector<std::uint32_t> last_current;
};

/// Textures of a group that travel together: all of them, or one.
struct Bundle {
  Bundle(const TextureGroup* group_in, std::uint8_t group_id_in, const RegionGrid& cut_in)
      : group(group_in),
        group_id(group_id_in),
        cut(cut_in),
        order(block_order(group_in->textures.front().desc)),
        regions(cut.regions()) {
    for (std::uint32_t region = 0; region < cut.regions(); ++region) {
      region_blocks.push_back(cut.blocks_of(region));
    }
  }

  const TextureGroup* group;
  std::uint8_t group_id;
  std::vector<std::unique_ptr<ServedTexture>> textures;
  const BlockHistory* first =
      nullptr;  ///< of the group's first texture, which determines dependencies and ranks
  RegionGrid cut;
  std::vector<std::uint32_t> order;  ///< by block, see block_order()
  std::vector<std::vector<std::uint32_t>> region_blocks;
  std::vector<SharedRegion> regions;
  bool due = false;            ///< takes part in this update, as do bundles it depends on
  bool is_dependency = false;  ///< blocks of another group depend on its blocks
  /// The backend of a texture is: who misses an update waits for a keyframe, which all get.
  bool is_stateful = false;

  [[nodiscard]] const TextureDesc& desc() const noexcept { return textures[0]->history.desc(); }
  /// The number of the update among those in which it may be due.
  [[nodiscard]] std::uint64_t turn(std::uint64_t update) const noexcept {
    return update / textures[0]->options.interval;
  }
  [[nodiscard]] bool outdated(std::span<const UpdateStream> streams,
                              std::uint32_t block) const noexcept;
  /// True if this bundle's blocks depend on those of `other`, which comes before it.
  [[nodiscard]] bool depends_on(const Bundle& other) const noexcept {
    return group->depends_on == other.group_id;
  }
  /// Where blocks depend on others: no state that clients hold counts as current any more, since
  /// blocks moved or became inactive.
  void forget_held() noexcept;
};

/// The blocks that the blocks of a group depend on, read from its current contents.
class Dependencies {
 public:
  void resize(std::uint32_t blocks) {
    begin_.resize(std::size_t{blocks} + 1);
    stale_.resize(blocks);
  }
  void set_stale(std::uint32_t block) noexcept { stale_[block] = 1; }
  [[nodiscard]] bool stale() const noexcept;
  /// Reads the stale blocks. `limit`: number of blocks of the group that they depend on.
  void refresh(const TextureGroup& group, const BlockHistory& first, std::uint32_t limit);
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::uint32_t block) const noexcept {
    return std::span(blocks_).subspan(begin_[block], begin_[block + 1] - begin_[block]);
  }
  /// The regions, as `cut` divides that group, that some blocks depend on: ascending.
  [[nodiscard]] std::vector<std::uint32_t> regions(std::span<const std::uint32_t> blocks,
                                                   const RegionGrid& cut) const;
  [[nodiscard]] std::size_t memory() const noexcept;  ///< bytes

 private:
  std::vector<std::size_t> begin_;  ///< in blocks_: where each block's list begins, and the end
  std::vector<std::uint32_t> blocks_;
  BlockMask stale_;
};

/// An entry of the server's table of volumes; a removed volume keeps its entry.
struct ServedVolume {
  /// The description for clients, with number, present geometry and region size.
  DescribedVolume described;
  std::uint32_t changed_in = 0;   ///< generation in which it was added or removed
  VolumeDesc desc;                ///< without groups if it was removed
  std::vector<BlockMask> active;  ///< by group; empty: all
  std::vector<std::unique_ptr<Bundle>> bundles;
  std::uint8_t textures = 0;
  bool linked = false;                     ///< some blocks depend on others
  std::vector<Dependencies> dependencies;  ///< if linked: by group

  [[nodiscard]] std::uint16_t id() const noexcept { return described.id; }
  [[nodiscard]] bool removed() const noexcept { return desc.groups.empty(); }
  [[nodiscard]] bool is_stateful() const noexcept;
  [[nodiscard]] bool is_lossy() const noexcept;  ///< the backend of a texture is
  /// Of a group.
  [[nodiscard]] std::uint32_t blocks(std::size_t group) const noexcept {
    return block_count(desc.groups[group].textures[0].desc);
  }
  [[nodiscard]] bool is_active(std::size_t group, std::uint32_t block) const noexcept {
    const BlockMask& mask = active[group];
    return mask.empty() || mask[block] != 0;
  }
  void choose_due(std::uint64_t update) noexcept;
  void note_change(Bundle& bundle, ServedTexture& texture, std::uint32_t block, BlockId before,
                   std::uint64_t update) noexcept;
};

}  // namespace gicodec
