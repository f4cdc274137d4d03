#include "session/update_stream.h"

#include <algorithm>
#include <cstring>

namespace gicodec {

void StreamScratch::load(const BlockHistory& history, std::span<const BlockId> sent) {
  const bool stale = history_ != &history || generation_ != history.generation();
  for (std::uint32_t probe = 0; probe < sent.size(); ++probe) {
    if (!stale && held_[probe] == sent[probe]) continue;
    mirror_.set_core(probe, history.core(sent[probe]));
    held_[probe] = sent[probe];
  }
  history_ = &history;
  generation_ = history.generation();
}

UpdateStream::UpdateStream(BlockHistory& history, const TextureDesc& desc,
                           std::vector<std::uint32_t> probes, PacketChain chain,
                           std::uint32_t max_unacknowledged)
    : history_(&history),
      desc_(desc),
      probes_(std::move(probes)),
      sent_(history, probe_count(desc), chain),
      max_unacknowledged_(max_unacknowledged) {}

UpdateStream::UpdateStream(UpdateStream&& other) noexcept = default;

UpdateStream::~UpdateStream() { forget_log(log_.size()); }

/// Forgets what the oldest packets replaced.
void UpdateStream::forget_log(std::size_t packets) noexcept {
  const auto end = log_.begin() + static_cast<std::ptrdiff_t>(packets);
  for (auto it = log_.begin(); it != end; ++it) forget(it->replaced);
  log_.erase(log_.begin(), end);
}

void UpdateStream::forget(const Replaced& replaced) noexcept {
  for (const auto& [probe, id] : replaced) history_->release(id);
}

void UpdateStream::request_keyframe() noexcept {
  sent_.clear();
  forget_log(log_.size());
  keyframe_wanted_ = true;
}

void UpdateStream::Wanted::add(std::uint32_t probe, BlockId block) {
  probes.push_back(probe);
  blocks.push_back(block);
}

Status UpdateStream::write(BackendEncoder& backend, std::span<const std::uint32_t> probes,
                           StreamScratch& scratch, std::vector<WrittenPacket>& out) {
  out.clear();
  Wanted known, fresh;
  for (const std::uint32_t probe : probes) {
    (moved(probe) && !keyframe_wanted_ ? fresh : known)
        .add(probe, history_->current()[source(probe)]);
  }
  PacketChain chain = sent_.chain;
  for (Wanted* wanted : {&known, &fresh}) {
    const bool keyframe = keyframe_wanted_ && wanted == &known;
    if (wanted->probes.empty() && !keyframe) continue;
    if (chain.sequence == UINT32_MAX) return Status::limit_exceeded;
    PacketHead head = chain.next(desc_, keyframe);
    head.info.fresh = wanted == &fresh;
    WrittenPacket written{.fresh = head.info.fresh};
    const Status status = write_one(sent_, backend, head, *wanted, scratch, written.packet);
    if (status != Status::ok) return status;
    chain.advance(written.packet);
    written.replaced.reserve(wanted->probes.size());
    written.probes = std::move(wanted->probes);
    out.push_back(std::move(written));
  }
  log_.reserve(log_.size() + out.size());
  return Status::ok;
}

/// Packets of a receiver that stands at `from`.
Status UpdateStream::write_one(const StreamState& from, BackendEncoder& backend,
                               const PacketHead& head, const Wanted& wanted, StreamScratch& scratch,
                               Packet& out) const {
  const std::size_t size = core_bytes(desc_);
  scratch.cores_.resize(wanted.probes.size() * size);
  StaleRings now, before;
  for (std::size_t i = 0; i < wanted.probes.size(); ++i) {
    const std::uint32_t probe = wanted.probes[i];
    const BlockId id = wanted.blocks[i];
    std::ranges::copy(history_->core(id), scratch.cores_.data() + i * size);
    const auto ring = history_->stale_ring(id),
               ring_before = history_->stale_ring(from.blocks()[probe]);
    if (!ring.empty()) now.add(probe, ring);
    if (!ring_before.empty()) before.add(probe, ring_before);
  }
  if (!head.info.keyframe && !head.info.fresh) scratch.load(*history_, from.blocks());
  scratch.mirror_.set_stale(before);
  return scratch.writer_.write(scratch.mirror_, backend, head, {wanted.probes, scratch.cores_, now},
                               out);
}

void UpdateStream::commit(WrittenPacket& written) noexcept {
  for (const std::uint32_t probe : written.probes) {
    const BlockId id = history_->current()[source(probe)];
    written.replaced.emplace_back(probe, sent_.replace(probe, id, false));
  }
  if (keyframe_wanted_) {
    forget(written.replaced);  // Nothing before a keyframe can be gone back to.
  } else {
    log_.push_back({sequence() + 1, checksum(), written.fresh, std::move(written.replaced)});
  }
  if (log_.size() > max_unacknowledged_) forget_log(log_.size() - max_unacknowledged_);
  keyframe_wanted_ = false;
  sent_.chain.advance(written.packet);
}

UpdateStream::Wanted UpdateStream::all_of(const StreamState& state) {
  Wanted wanted;
  for (std::uint32_t probe = 0; probe < state.probes(); ++probe) {
    if (state.blocks()[probe] != kZeroBlock) wanted.add(probe, state.blocks()[probe]);
  }
  return wanted;
}

Status UpdateStream::difference(const StreamState& from, StreamState& to, bool stand_in,
                                BackendEncoder& backend, StreamScratch& scratch,
                                std::vector<WrittenPacket>& out) const {
  Wanted known, fresh;
  for (std::uint32_t probe = 0; probe < to.probes(); ++probe) {
    const bool differs = from.blocks()[probe] != to.blocks()[probe];
    if (from.moved(probe) ? differs || !to.moved(probe) : differs) {
      (from.moved(probe) ? fresh : known).add(probe, to.blocks()[probe]);
    }
  }
  Wanted* const last = fresh.probes.empty() ? &known : &fresh;
  PacketChain at = from.chain;
  for (Wanted* wanted : {&known, &fresh}) {
    if (wanted->probes.empty() && wanted != last) continue;
    // Where both are needed, what they stand for were two packets at least.
    PacketHead head = stand_in && wanted == last ? at.skip(desc_, to.chain) : at.next(desc_, false);
    if (!stand_in) head.info.sequence = ++to.chain.sequence;
    head.info.fresh = wanted == &fresh;
    WrittenPacket written{.fresh = head.info.fresh};
    const Status status = write_one(from, backend, head, *wanted, scratch, written.packet);
    if (status != Status::ok) return status;
    at.sequence = head.info.sequence;
    at.checksum = packet_checksum(written.packet);
    written.probes = std::move(wanted->probes);
    out.push_back(std::move(written));
  }
  if (!stand_in) to.chain.checksum = at.checksum;
  return Status::ok;
}

Status UpdateStream::next(const StreamState* from, std::span<const std::uint32_t> probes,
                          BackendEncoder& backend, StreamScratch& scratch, StreamState& to,
                          std::vector<WrittenPacket>& out) const {
  constexpr std::uint32_t kPackets = 2;
  out.clear();
  if (sequence() > UINT32_MAX - kPackets) return Status::limit_exceeded;
  to = sent_;
  for (const std::uint32_t probe : probes) {
    history_->release(to.replace(probe, history_->current()[source(probe)], false));
  }
  if (from != nullptr) return difference(*from, to, false, backend, scratch, out);
  Wanted wanted = all_of(to);
  WrittenPacket written;
  const Status status =
      write_one(to, backend, to.chain.next(desc_, true), wanted, scratch, written.packet);
  if (status != Status::ok) return status;
  to.chain.advance(written.packet);
  written.probes = std::move(wanted.probes);
  out.push_back(std::move(written));
  return Status::ok;
}

void UpdateStream::move_to(StreamState&& to) noexcept {
  sent_ = std::move(to);
  keyframe_wanted_ = false;
}

Status UpdateStream::snapshot(BackendEncoder& backend, StreamScratch& scratch, Packet& out) const {
  return write_one(sent_, backend, sent_.chain.snapshot(desc_), all_of(sent_), scratch, out);
}

Status UpdateStream::skip(const StreamState& from, BackendEncoder& backend, StreamScratch& scratch,
                          std::vector<WrittenPacket>& out) const {
  out.clear();
  StreamState to = sent_;
  return difference(from, to, true, backend, scratch, out);
}

void UpdateStream::acknowledge(std::uint32_t sequence) noexcept {
  const auto later = [&](const Unacknowledged& packet) { return packet.sequence > sequence; };
  forget_log(static_cast<std::size_t>(std::ranges::find_if(log_, later) - log_.begin()));
}

bool UpdateStream::resume(std::uint32_t sequence, std::uint32_t checksum) noexcept {
  PacketChain& chain = sent_.chain;
  // The log's entries are consecutive and end with the chain's sequence.
  const bool known =
      sequence > 0 && sequence <= chain.sequence && chain.sequence - sequence <= log_.size() &&
      checksum == (sequence == chain.sequence
                       ? chain.checksum
                       : log_[log_.size() - (chain.sequence - sequence)].checksum_before);
  if (!known) {
    request_keyframe();
    return false;
  }
  while (chain.sequence > sequence) {
    Unacknowledged& last = log_.back();
    for (const auto& [probe, id] : last.replaced) {
      history_->release(sent_.replace(probe, id, last.fresh || moved(probe)));
      history_->release(id);  // That the log held.
    }
    chain.checksum = last.checksum_before;
    log_.pop_back();
    --chain.sequence;
  }
  return true;
}

std::size_t UpdateStream::memory() const noexcept {
  std::size_t bytes = sent_.memory() + probes_.capacity() * sizeof(std::uint32_t);
  for (const auto& packet : log_) {
    bytes += sizeof packet + packet.replaced.capacity() * sizeof packet.replaced[0];
  }
  return bytes;
}

}  // namespace gicodec
