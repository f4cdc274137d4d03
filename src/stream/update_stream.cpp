#include "stream/update_stream.h"

#include "bitstream/description.h"

#include <algorithm>

namespace gicodec {
namespace {

/// Merges both packets into one intra packet.
void make_all_intra(Written& out) {
  Contents all;
  Contents &stayed = out.stayed(), &moved = out.moved();
  all.reserve(stayed.blocks.size() + moved.blocks.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < moved.blocks.size(); ++i) {
    for (; next < stayed.blocks.size() && stayed.blocks[next] < moved.blocks[i]; ++next) {
      all.add(stayed.blocks[next], stayed.ids[next]);
    }
    all.add(moved.blocks[i], moved.ids[i]);
  }
  for (; next < stayed.blocks.size(); ++next) all.add(stayed.blocks[next], stayed.ids[next]);
  moved = std::move(all);
  stayed.clear();
}

}  // namespace

void Written::clear() noexcept {
  first = number = 0;
  already_held.clear();
  for (WrittenPacket& packet : of) {
    packet.repeats_all = false;
    packet.contents.clear();
    packet.replaced.clear();
  }
}

UpdateStream::UpdateStream(BlockHistory& history, const TextureDesc& desc,
                           std::span<const std::uint32_t> volume_blocks, PacketChain chain,
                           std::uint32_t max_unacknowledged)
    : history_(&history),
      desc_(desc),
      description_(description_hash(desc)),
      volume_blocks_(volume_blocks.begin(), volume_blocks.end()),
      sent_(history, block_count(desc), chain),
      max_unacknowledged_(max_unacknowledged) {}

UpdateStream::UpdateStream(UpdateStream&& other) noexcept = default;

UpdateStream::~UpdateStream() { forget_log(log_.size()); }

/// Drops the oldest packets from the log, and releases what they replaced.
void UpdateStream::forget_log(std::size_t packets) noexcept {
  const auto end = log_.begin() + static_cast<std::ptrdiff_t>(packets);
  for (auto it = log_.begin(); it != end; ++it) {
    for (const auto& [block, id] : it->replaced) history_->release(id);
  }
  log_.erase(log_.begin(), end);
}

void UpdateStream::request_keyframe() noexcept {
  sent_.clear();
  forget_log(log_.size());
  keyframe_wanted_ = true;
}

/// Calls visit(block, id, lacks, wanted) for all blocks. `wanted`: the block is in `blocks`. `id`:
/// the current contents if wanted, else those sent. `lacks`: a receiver of `from` (null: one that
/// holds nothing) needs `id`.
template <typename Visit>
void UpdateStream::for_each_missing(const StreamState* from, std::span<const std::uint32_t> blocks,
                                    const Visit& visit) const {
  auto next = blocks.begin();
  for (std::uint32_t block = 0; block < size(); ++block) {
    const bool wanted = next != blocks.end() && *next == block;
    if (wanted) ++next;
    const BlockId id = wanted ? current(block) : sent(block);
    const BlockId held = from == nullptr ? kNothing : from->blocks()[block];
    const bool arrived = from != nullptr && from->moved(block) && (wanted || !moved(block));
    visit(block, id, held != id || arrived, wanted);
  }
}

void UpdateStream::mark_missing(const StreamState& from, std::span<const std::uint32_t> blocks,
                                std::span<std::uint8_t> missing) const noexcept {
  for_each_missing(&from, blocks, [&](std::uint32_t block, BlockId, bool lacks, bool) {
    if (lacks) missing[block] = 1;
  });
}

/// Plans the packets that give a receiver of `from` what it lacks.
void UpdateStream::plan_difference(const StreamState* from, std::span<const std::uint32_t> blocks,
                                   std::span<const std::uint8_t> also, Written& out) const {
  out.clear();
  for_each_missing(from, blocks, [&](std::uint32_t block, BlockId id, bool lacks, bool wanted) {
    if (lacks || (!also.empty() && also[block] != 0)) {
      (from != nullptr && from->moved(block) ? out.moved() : out.stayed()).add(block, id);
    } else if (wanted) {
      out.already_held.add(block, id);
    }
  });
}

Status UpdateStream::write(From from, std::span<const std::uint32_t> blocks,
                           BackendEncoder& backend, PacketWriter& writer, Written& out) {
  const bool keyframe = from == From::keyframe;
  out.clear();
  out.stayed().reserve(blocks.size());
  for (const std::uint32_t block : blocks) {
    (moved(block) && !keyframe ? out.moved() : out.stayed()).add(block, current(block));
  }
  const Status status = write_planned(keyframe ? nullptr : &sent_, false, backend, writer, out);
  if (status == Status::ok) log_.reserve(log_.size() + out.number);
  return status;
}

Status UpdateStream::write_from(const StreamState* from, std::span<const std::uint32_t> blocks,
                                std::span<const std::uint8_t> also, BackendEncoder& backend,
                                PacketWriter& writer, Written& out) const {
  plan_difference(from, blocks, also, out);
  const Status status = write_planned(from, false, backend, writer, out);
  for (WrittenPacket& packet : out.packets()) packet.repeats_all = is_keyframe(packet.type);
  return status;
}

Status UpdateStream::catch_up(const StreamState* from, std::span<const std::uint8_t> also,
                              BackendEncoder& backend, PacketWriter& writer, Written& out) const {
  plan_difference(from, {}, also, out);
  return write_planned(from, true, backend, writer, out);
}

/// Writes the planned packets for receivers of `from` (null: ones that hold nothing): the stream's
/// next packets, or a stand-in for all since `from`.
Status UpdateStream::write_planned(const StreamState* from, bool stand_in, BackendEncoder& backend,
                                   PacketWriter& writer, Written& out) const {
  constexpr std::uint32_t kPackets = 2;
  if (sequence() > UINT32_MAX - kPackets) return Status::limit_exceeded;
  PacketChain at = from == nullptr ? sent_.chain : from->chain;
  std::uint32_t last = sequence();
  // A stand-in for a single packet has one sequence number, so it must be one packet.
  const bool both = !out.stayed().blocks.empty() && !out.moved().blocks.empty();
  if (stand_in && both && last - at.sequence < kPackets) make_all_intra(out);
  const std::size_t final = out.moved().blocks.empty() ? 0 : 1;
  out.first = out.stayed().blocks.empty() ? final : 0;
  for (std::size_t i = out.first; i <= final; ++i) {
    WrittenPacket& written = out.of[i];
    written.type = from == nullptr ? PacketType::keyframe
                   : i == 1        ? PacketType::intra
                                   : PacketType::delta;
    PacketHead head = stand_in && i == final ? at.stand_in(description_, written.type, sent_.chain)
                                             : at.next(description_, written.type);
    if (!stand_in) head.info.sequence = ++last;
    std::span<const BlockId> held = (from == nullptr ? sent_ : *from).blocks();
    if (i > out.first) {
      out.held_after_first.assign(held.begin(), held.end());
      const auto& [blocks, ids] = out.stayed();
      for (std::size_t k = 0; k < blocks.size(); ++k) out.held_after_first[blocks[k]] = ids[k];
      held = out.held_after_first;
    }
    const Status status = writer.write(desc_, *history_, held, written.contents, backend, head,
                                       written.packet, written.decoded);
    if (status != Status::ok) return status;
    at.sequence = written.sequence = head.info.sequence;
    at.checksum = written.checksum = packet_checksum(written.packet);
    if (max_unacknowledged_ > 0) written.replaced.reserve(written.contents.blocks.size());
    ++out.number;
  }
  return Status::ok;
}

void UpdateStream::commit(Written& written) noexcept {
  const std::size_t bytes = block_bytes(desc_);
  for (WrittenPacket& packet : written.packets()) {
    const bool keyframe = is_keyframe(packet.type);
    if (keyframe && !packet.repeats_all) request_keyframe();
    // resume() cannot go back beyond a keyframe.
    const bool logged = !keyframe && max_unacknowledged_ > 0;
    const auto& [blocks, ids] = packet.contents;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      // A keyframe that repeats all may have contents of a block's former place.
      const bool elsewhere = packet.repeats_all && moved(blocks[i]) && ids[i] != current(blocks[i]);
      const BlockId before = sent_.replace(blocks[i], ids[i], elsewhere);
      if (logged) {
        packet.replaced.emplace_back(blocks[i], before);
      } else {
        history_->release(before);
      }
      if (!packet.decoded.empty()) {
        history_->replace(ids[i], std::span(packet.decoded).subspan(i * bytes, bytes));
      }
    }
    if (logged) {
      log_.push_back(
          {sequence() + 1, checksum(), is_intra(packet.type), std::move(packet.replaced)});
    }
    keyframe_wanted_ = false;
    ++sent_.chain.sequence;
    sent_.chain.checksum = packet.checksum;
  }
  for (std::size_t i = 0; i < written.already_held.blocks.size(); ++i) {
    history_->release(
        sent_.replace(written.already_held.blocks[i], written.already_held.ids[i], false));
  }
  if (log_.size() > max_unacknowledged_) forget_log(log_.size() - max_unacknowledged_);
}

void UpdateStream::acknowledge(std::uint32_t sequence) noexcept {
  const auto later = [&](const Unacknowledged& packet) { return packet.sequence > sequence; };
  const auto first = std::find_if(log_.begin(), log_.end(), later);
  forget_log(static_cast<std::size_t>(first - log_.begin()));
}

bool UpdateStream::resume(std::uint32_t sequence, std::uint32_t checksum) noexcept {
  PacketChain& chain = sent_.chain;
  // The log's entries are consecutive and end with the chain's sequence.
  const bool in_log =
      sequence > 0 && sequence <= chain.sequence && chain.sequence - sequence <= log_.size() &&
      checksum == (sequence == chain.sequence
                       ? chain.checksum
                       : log_[log_.size() - (chain.sequence - sequence)].checksum_before);
  if (!in_log) {
    request_keyframe();
    return false;
  }
  while (chain.sequence > sequence) {
    Unacknowledged& last = log_.back();
    for (const auto& [block, id] : last.replaced) {
      history_->release(sent_.replace(block, id, last.intra || moved(block)));
      history_->release(id);  // the log's hold
    }
    chain.checksum = last.checksum_before;
    log_.pop_back();
    --chain.sequence;
  }
  return true;
}

std::size_t UpdateStream::memory() const noexcept {
  std::size_t bytes = sent_.memory() + volume_blocks_.capacity() * sizeof(std::uint32_t);
  for (const auto& packet : log_) {
    bytes += sizeof packet + packet.replaced.capacity() * sizeof packet.replaced[0];
  }
  return bytes;
}

}  // namespace gicodec
