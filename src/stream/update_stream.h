// One chain of packets for some blocks of a texture, out of its history: an encoder's or a client's
// own chain over the whole volume, or a region's that many clients share. Knows what was sent last,
// so that it can be compared, predicted from, and taken back.
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

/// What a receiver held of some blocks before a packet.
using Replaced = Vector<std::pair<std::uint32_t, BlockId>>;

struct WrittenPacket {
  PacketType type = PacketType::delta;  ///< of a stand-in, what it would be without
  bool whole = false;                   ///< a keyframe of all that was sent
  Contents contents = {};
  Packet packet = {};
  std::uint32_t sequence = 0, checksum = 0;
  std::vector<std::byte> decoded = {};  ///< by a lossy backend, instead of the contents
  Replaced replaced = {};               ///< room for them
};

/// Packets that are not sent yet. Keeps its capacity from one to the next.
struct Written {
  WrittenPacket of[2] = {};           ///< contents of known places, and of places that moved
  std::size_t first = 0, number = 0;  ///< those of them that are written
  Contents silent = {};               ///< what changes for the stream without being in a packet
  Vector<BlockId> held = {};          ///< what a receiver holds between the two packets

  [[nodiscard]] std::span<WrittenPacket> packets() noexcept { return {of + first, number}; }
  [[nodiscard]] std::span<const WrittenPacket> packets() const noexcept {
    return {of + first, number};
  }
  [[nodiscard]] Contents& known() noexcept { return of[0].contents; }
  [[nodiscard]] Contents& intra() noexcept { return of[1].contents; }
  void clear() noexcept;
};

class UpdateStream {
 public:
  /// `sources`: the history's block for each block of `desc`; empty for the same ones. `history`
  /// must outlive the stream.
  UpdateStream(BlockHistory& history, const TextureDesc& desc,
               std::span<const std::uint32_t> sources, PacketChain chain,
               std::uint32_t max_unacknowledged);
  UpdateStream(UpdateStream&& other) noexcept;
  UpdateStream& operator=(UpdateStream&&) = delete;
  ~UpdateStream();

  [[nodiscard]] const TextureDesc& desc() const noexcept { return desc_; }
  [[nodiscard]] std::uint32_t size() const noexcept {
    return static_cast<std::uint32_t>(sent_.blocks().size());
  }
  [[nodiscard]] std::uint32_t source(std::uint32_t block) const noexcept {
    return sources_.empty() ? block : sources_[block];
  }
  /// What is current of a block.
  [[nodiscard]] BlockId current(std::uint32_t block) const noexcept {
    return history_->current()[source(block)];
  }
  /// True if the receiver has other contents than the current ones, or some of another place.
  [[nodiscard]] bool differs(std::uint32_t block) const noexcept {
    return moved(block) || sent(block) != current(block);
  }
  /// True if what the receiver has belongs to the place where the block stood before.
  [[nodiscard]] bool moved(std::uint32_t block) const noexcept { return sent_.moved(block); }
  /// What the receiver holds, if it applied everything that was committed.
  [[nodiscard]] BlockId sent(std::uint32_t block) const noexcept { return sent_.blocks()[block]; }
  [[nodiscard]] const StreamState& state() const noexcept { return sent_; }
  [[nodiscard]] bool keyframe_next() const noexcept { return keyframe_wanted_; }
  /// The next packet is a keyframe; until then the receiver counts as holding nothing.
  void request_keyframe() noexcept;

  enum class From : std::uint8_t {
    sent,      ///< what was sent last: a packet of exactly the blocks asked for
    keyframe,  ///< nothing: a keyframe of exactly these, after which nothing else is held
  };
  /// Writes the packets that give the receiver the current contents of `blocks` (ascending,
  /// unique): one, and an intra one for those of them that moved. Changes nothing but capacities
  /// here; commit(), before the next publish(), does, and cannot fail.
  Status write(From from, std::span<const std::uint32_t> blocks, BackendEncoder& backend,
               PacketWriter& writer, Written& out);
  /// The same for receivers who hold `from`, an earlier state of this stream, or nothing (null) and
  /// get a keyframe of all that was sent, too. `also`: blocks that such receivers get whether they
  /// lack them or not, one byte each; empty for none.
  Status write_from(const StreamState* from, std::span<const std::uint32_t> blocks,
                    std::span<const std::uint8_t> also, BackendEncoder& backend,
                    PacketWriter& writer, Written& out) const;
  /// Marks what a receiver of `from` lacks of what was sent and of the current `blocks`.
  void mark_missing(const StreamState& from, std::span<const std::uint32_t> blocks,
                    std::span<std::uint8_t> missing) const noexcept;
  void commit(Written& written) noexcept;

  /// These blocks stand elsewhere from now on.
  void set_moved(std::span<const std::uint32_t> blocks) noexcept { sent_.set_moved(blocks); }

  /// What a receiver of `from` lacks of what was sent since, in packets after which it follows this
  /// stream; null: a keyframe of all that was sent. `also` as above. Precondition: sequence() > 0.
  Status catch_up(const StreamState* from, std::span<const std::uint8_t> also,
                  BackendEncoder& backend, PacketWriter& writer, Written& out) const;

  /// The receiver has applied everything up to this sequence.
  void acknowledge(std::uint32_t sequence) noexcept;
  /// The receiver holds the state after this packet and nothing later: takes back what was
  /// committed since. False if that is not known any more; a keyframe comes next then.
  bool resume(std::uint32_t sequence, std::uint32_t checksum) noexcept;

  [[nodiscard]] std::uint32_t sequence() const noexcept { return sent_.chain.sequence; }
  [[nodiscard]] std::uint32_t checksum() const noexcept { return sent_.chain.checksum; }
  [[nodiscard]] std::size_t memory() const noexcept;  ///< bytes

 private:
  /// What a committed packet replaced, kept until it is acknowledged.
  struct Unacknowledged {
    std::uint32_t sequence, checksum_before;
    bool intra;
    Replaced replaced;
  };
  template <typename Visit>
  void for_each_lacking(const StreamState* from, std::span<const std::uint32_t> blocks,
                        const Visit& visit) const;
  void plan_difference(const StreamState* from, std::span<const std::uint32_t> blocks,
                       std::span<const std::uint8_t> also, Written& out) const;
  Status write_planned(const StreamState* from, bool stand_in, BackendEncoder& backend,
                       PacketWriter& writer, Written& out) const;
  void forget_log(std::size_t packets) noexcept;

  BlockHistory* history_;
  TextureDesc desc_;
  std::uint32_t description_;  ///< its hash
  Vector<std::uint32_t> sources_;
  StreamState sent_;
  Vector<Unacknowledged> log_;  ///< oldest first
  std::uint32_t max_unacknowledged_;
  bool keyframe_wanted_ = true;
};

}  // namespace gicodec
