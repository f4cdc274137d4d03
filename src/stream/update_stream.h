// A chain of packets for some blocks of a texture's history: an encoder's or a client's unicast
// chain for the whole volume, or a shared one for a region. Knows what was sent last, to
// compare with, to predict from, and to go back to.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/packet.h>

#include "base/memory.h"
#include "stream/block_history.h"
#include "stream/packet_writer.h"
#include "stream/stream_state.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace gicodec {

/// The contents of some blocks before a packet, by block.
using Replaced = Vector<std::pair<std::uint32_t, BlockId>>;

struct WrittenPacket {
  PacketType type = PacketType::delta;  ///< of a stand-in: keyframe, delta or intra
  bool repeats_all = false;             ///< a keyframe that also has all blocks sent before
  Contents contents = {};
  Packet packet = {};
  std::uint32_t sequence = 0, checksum = 0;
  std::vector<std::byte> decoded = {};  ///< a lossy backend's contents
  Replaced replaced = {};               ///< capacity for commit()
};

/// Packets that are not committed yet. Reused for its capacity.
struct Written {
  WrittenPacket of[2] = {};               ///< see stayed() and moved()
  std::size_t first = 0, number = 0;      ///< those written: `number` from `first` on
  Contents already_held = {};             ///< selected, but in no packet: the receiver holds them
  Vector<BlockId> held_after_first = {};  ///< the receiver's state between the two packets

  [[nodiscard]] std::span<WrittenPacket> packets() noexcept { return {of + first, number}; }
  [[nodiscard]] std::span<const WrittenPacket> packets() const noexcept {
    return {of + first, number};
  }
  /// Blocks of the first packet, a keyframe or a delta: those at the place where the receiver has
  /// them; of a keyframe all.
  [[nodiscard]] Contents& stayed() noexcept { return of[0].contents; }
  /// Blocks of the second packet, an intra one: those that stand elsewhere since they were sent.
  [[nodiscard]] Contents& moved() noexcept { return of[1].contents; }
  void clear() noexcept;
};

class UpdateStream {
 public:
  /// `volume_blocks`: for each block of `desc` its block in the volume, by which `history` knows
  /// it; empty: the same. `history` must outlive the stream.
  UpdateStream(BlockHistory& history, const TextureDesc& desc,
               std::span<const std::uint32_t> volume_blocks, PacketChain chain,
               std::uint32_t max_unacknowledged);
  UpdateStream(UpdateStream&& other) noexcept;
  UpdateStream& operator=(UpdateStream&&) = delete;
  ~UpdateStream();

  [[nodiscard]] const TextureDesc& desc() const noexcept { return desc_; }
  [[nodiscard]] std::uint32_t size() const noexcept {
    return static_cast<std::uint32_t>(sent_.blocks().size());
  }
  /// A block's block in the volume.
  [[nodiscard]] std::uint32_t volume_block(std::uint32_t block) const noexcept {
    return volume_blocks_.empty() ? block : volume_blocks_[block];
  }
  /// The current contents of a block.
  [[nodiscard]] BlockId current(std::uint32_t block) const noexcept {
    return history_->current()[volume_block(block)];
  }
  /// True if the receiver's contents are not current, or belong to another place.
  [[nodiscard]] bool differs(std::uint32_t block) const noexcept {
    return moved(block) || sent(block) != current(block);
  }
  /// True if the receiver's contents belong to the block's former place.
  [[nodiscard]] bool moved(std::uint32_t block) const noexcept { return sent_.moved(block); }
  /// The contents that a receiver holds after all committed packets.
  [[nodiscard]] BlockId sent(std::uint32_t block) const noexcept { return sent_.blocks()[block]; }
  [[nodiscard]] const StreamState& state() const noexcept { return sent_; }
  [[nodiscard]] bool keyframe_next() const noexcept { return keyframe_wanted_; }
  /// Makes the next packet a keyframe; until then the receiver counts as holding nothing.
  void request_keyframe() noexcept;

  enum class From : std::uint8_t {
    sent,      ///< the last state sent: a packet of exactly these blocks
    keyframe,  ///< nothing: a keyframe of exactly these blocks, which clears all others
  };
  /// Writes the packets that give the receiver the current contents of `blocks` (ascending,
  /// unique): one, and a second one (intra) if blocks moved. The state does not change yet: call
  /// commit(), which cannot fail, before the next publish().
  Status write(From from, std::span<const std::uint32_t> blocks, BackendEncoder& backend,
               PacketWriter& writer, Written& out);
  /// Like write(), for receivers in the earlier state `from`: their packets also hold what was sent
  /// since `from`. Null: receivers that hold nothing get a keyframe of all that was sent. `also`:
  /// one byte per block, not 0 for blocks to send in any case; or empty.
  Status write_from(const StreamState* from, std::span<const std::uint32_t> blocks,
                    std::span<const std::uint8_t> also, BackendEncoder& backend,
                    PacketWriter& writer, Written& out) const;
  /// Sets `missing` to 1 for blocks that a receiver of `from` lacks, of what was sent and of the
  /// current `blocks`.
  void mark_missing(const StreamState& from, std::span<const std::uint32_t> blocks,
                    std::span<std::uint8_t> missing) const noexcept;
  void commit(Written& written) noexcept;

  /// Notes that these blocks stand elsewhere from now on.
  void set_moved(std::span<const std::uint32_t> blocks) noexcept { sent_.set_moved(blocks); }

  /// Writes a catch-up: packets that bring a receiver of `from` to this stream's state; null: a
  /// snapshot of all that was sent. `also` as above. Precondition: sequence() > 0.
  Status catch_up(const StreamState* from, std::span<const std::uint8_t> also,
                  BackendEncoder& backend, PacketWriter& writer, Written& out) const;

  /// Call when the receiver has applied all packets up to `sequence`.
  void acknowledge(std::uint32_t sequence) noexcept;
  /// Call when the receiver holds the state after this packet and nothing later: undoes what was
  /// committed since. False if that state is unknown; a keyframe comes next.
  bool resume(std::uint32_t sequence, std::uint32_t checksum) noexcept;

  [[nodiscard]] std::uint32_t sequence() const noexcept { return sent_.chain.sequence; }
  [[nodiscard]] std::uint32_t checksum() const noexcept { return sent_.chain.checksum; }
  [[nodiscard]] std::size_t memory() const noexcept;  ///< bytes

 private:
  /// What a committed packet replaced, until it is acknowledged.
  struct Unacknowledged {
    std::uint32_t sequence, checksum_before;
    bool intra;
    Replaced replaced;
  };
  template <typename Visit>
  void for_each_missing(const StreamState* from, std::span<const std::uint32_t> blocks,
                        const Visit& visit) const;
  void plan_difference(const StreamState* from, std::span<const std::uint32_t> blocks,
                       std::span<const std::uint8_t> also, Written& out) const;
  Status write_planned(const StreamState* from, bool stand_in, BackendEncoder& backend,
                       PacketWriter& writer, Written& out) const;
  void forget_log(std::size_t packets) noexcept;

  BlockHistory* history_;
  TextureDesc desc_;
  std::uint32_t description_;  ///< its hash
  Vector<std::uint32_t> volume_blocks_;
  StreamState sent_;
  Vector<Unacknowledged> log_;  ///< oldest first
  std::uint32_t max_unacknowledged_;
  bool keyframe_wanted_ = true;
};

}  // namespace gicodec
