// One chain of packets for some probes of a texture, out of its history: a client's own chain over
// the whole volume, or a chunk's that many clients share. Knows what was sent last, so that it can
// be compared, predicted from, and taken back.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/packet.h>

#include "session/block_history.h"
#include "session/stream_state.h"
#include "stream/mirror.h"
#include "stream/update_writer.h"

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace gicodec {

/// Working memory for writing packets of streams of one description; one per thread.
class StreamScratch {
 public:
  explicit StreamScratch(const TextureDesc& desc) : mirror_(desc), held_(probe_count(desc)) {}
  [[nodiscard]] const TextureDesc& desc() const noexcept { return mirror_.desc(); }
  [[nodiscard]] std::size_t memory() const noexcept {
    return mirror_.cores().size() + cores_.capacity() + held_.capacity() * sizeof(BlockId);
  }

 private:
  friend class UpdateStream;
  /// Makes the mirror that of a stream. Successive streams differ in few probes.
  void load(const BlockHistory& history, std::span<const BlockId> sent);

  Mirror mirror_;
  std::vector<BlockId> held_;              ///< what the mirror's probes are copies of
  const BlockHistory* history_ = nullptr;  ///< that the mirror was loaded from
  std::uint64_t generation_ = 0;  ///< of the history; block numbers mean others in the next
  std::vector<std::byte> cores_;
  UpdateWriter writer_;
};

/// Blocks that a receiver held before a packet, by probe.
using Replaced = std::vector<std::pair<std::uint32_t, BlockId>>;

/// A packet, the probes in it, and room for what it replaces at the receiver.
struct WrittenPacket {
  std::vector<std::uint32_t> probes = {};
  Packet packet = {};
  bool fresh = false;
  Replaced replaced = {};
};

class UpdateStream {
 public:
  /// `probes`: the history's probe for each probe of `desc`; empty for the same ones. `history`
  /// must outlive the stream.
  UpdateStream(BlockHistory& history, const TextureDesc& desc, std::vector<std::uint32_t> probes,
               PacketChain chain, std::uint32_t max_unacknowledged);
  UpdateStream(UpdateStream&& other) noexcept;
  UpdateStream& operator=(UpdateStream&&) = delete;
  ~UpdateStream();

  [[nodiscard]] const TextureDesc& desc() const noexcept { return desc_; }
  [[nodiscard]] std::uint32_t probes() const noexcept { return sent_.probes(); }
  [[nodiscard]] std::uint32_t source(std::uint32_t probe) const noexcept {
    return probes_.empty() ? probe : probes_[probe];
  }
  /// True if the receiver has another block than the current one, or one of another place.
  [[nodiscard]] bool differs(std::uint32_t probe) const noexcept {
    return moved(probe) || sent(probe) != history_->current()[source(probe)];
  }
  /// True if what the receiver has belongs to the place where the probe stood before.
  [[nodiscard]] bool moved(std::uint32_t probe) const noexcept { return sent_.moved(probe); }
  /// What the receiver holds, if it applied everything that was committed.
  [[nodiscard]] BlockId sent(std::uint32_t probe) const noexcept { return sent_.blocks()[probe]; }
  [[nodiscard]] const StreamState& state() const noexcept { return sent_; }
  [[nodiscard]] bool keyframe_next() const noexcept { return keyframe_wanted_; }
  /// The next packet is a keyframe; until then the receiver counts as holding nothing.
  void request_keyframe() noexcept;

  /// Writes the packets that give the receiver the current blocks of `probes` (ascending, unique):
  /// one, and a fresh one for those of them that moved. Changes nothing but capacities here;
  /// commit() of all that was written, before the next publish(), does, and cannot fail.
  Status write(BackendEncoder& backend, std::span<const std::uint32_t> probes,
               StreamScratch& scratch, std::vector<WrittenPacket>& out);
  void commit(WrittenPacket& written) noexcept;

  /// These probes stand elsewhere from now on.
  void set_moved(std::span<const std::uint32_t> probes) noexcept { sent_.set_moved(probes); }

  // Of a stream with many receivers, who hold different states of it. Whatever one of them is sent,
  // the next packets of the stream are for all who hold what it then does.

  /// The stream's next state `to`, with the current blocks of `probes`, and the packets that take a
  /// receiver there from `from`, a state of this stream; null: from nothing, by a keyframe. Changes
  /// nothing here; move_to() does, before the next publish().
  Status next(const StreamState* from, std::span<const std::uint32_t> probes,
              BackendEncoder& backend, StreamScratch& scratch, StreamState& to,
              std::vector<WrittenPacket>& out) const;
  void move_to(StreamState&& to) noexcept;
  /// A keyframe of what was sent so far, after which a new receiver follows this stream.
  /// Precondition: sequence() > 0.
  Status snapshot(BackendEncoder& backend, StreamScratch& scratch, Packet& out) const;
  /// What a receiver of an earlier state of this stream lacks of what was sent since, in packets
  /// after which it follows this stream.
  Status skip(const StreamState& from, BackendEncoder& backend, StreamScratch& scratch,
              std::vector<WrittenPacket>& out) const;

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
    bool fresh;
    Replaced replaced;
  };
  /// Probes, and the blocks that the receiver is to hold of them.
  struct Wanted {
    std::vector<std::uint32_t> probes = {};
    std::vector<BlockId> blocks = {};
    void add(std::uint32_t probe, BlockId block);
  };
  /// Every block that is not zero.
  [[nodiscard]] static Wanted all_of(const StreamState& state);
  /// Packets from one state to another. They are the stream's next, with numbers in `to`, or stand
  /// for those that led to `to`.
  Status difference(const StreamState& from, StreamState& to, bool stand_in,
                    BackendEncoder& backend, StreamScratch& scratch,
                    std::vector<WrittenPacket>& out) const;
  Status write_one(const StreamState& from, BackendEncoder& backend, const PacketHead& head,
                   const Wanted& wanted, StreamScratch& scratch, Packet& out) const;
  void forget_log(std::size_t packets) noexcept;
  void forget(const Replaced& replaced) noexcept;

  BlockHistory* history_;
  TextureDesc desc_;
  std::vector<std::uint32_t> probes_;
  StreamState sent_;
  std::vector<Unacknowledged> log_;  ///< oldest first
  std::uint32_t max_unacknowledged_;
  bool keyframe_wanted_ = true;
};

}  // namespace gicodec
