#include "session/update_stream.h"

#include "stream/state_hash.h"

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
      sent_(probe_count(desc), kZeroBlock),
      moved_(probe_count(desc)),
      max_unacknowledged_(max_unacknowledged),
      chain_(chain) {
  for (const BlockId id : sent_) history_->hold(id);
}

UpdateStream::UpdateStream(UpdateStream&& other) noexcept = default;

UpdateStream::~UpdateStream() {
  for (const BlockId id : sent_) history_->release(id);
  forget_log(log_.size());
}

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
  for (BlockId& id : sent_) {
    history_->release(std::exchange(id, kZeroBlock));
    history_->hold(kZeroBlock);
  }
  forget_log(log_.size());
  keyframe_wanted_ = true;
}

Status UpdateStream::write(BackendEncoder& backend, std::span<const std::uint32_t> probes,
                           StreamScratch& scratch, std::vector<WrittenPacket>& out) {
  out.clear();
  WrittenPacket known, fresh{.fresh = true};
  for (const std::uint32_t probe : probes) {
    (moved(probe) && !keyframe_wanted_ ? fresh : known).probes.push_back(probe);
  }
  PacketChain chain = chain_;
  for (WrittenPacket* written : {&known, &fresh}) {
    const bool keyframe = keyframe_wanted_ && written == &known;
    if (written->probes.empty() && !keyframe) continue;
    if (chain.sequence == UINT32_MAX) return Status::limit_exceeded;
    PacketHead head = chain.next(desc_, keyframe);
    head.info.fresh = written->fresh;
    const Status status = write_one(backend, head, written->probes, scratch, written->packet);
    if (status != Status::ok) return status;
    chain.advance(written->packet);
    written->replaced.reserve(written->probes.size());
    out.push_back(std::move(*written));
  }
  log_.reserve(log_.size() + out.size());
  return Status::ok;
}

Status UpdateStream::write_one(BackendEncoder& backend, PacketHead head,
                               std::span<const std::uint32_t> probes, StreamScratch& scratch,
                               Packet& out) const {
  const std::size_t size = core_bytes(desc_);
  scratch.cores_.resize(probes.size() * size);
  StaleRings now, before;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const BlockId id = history_->current()[source(probes[i])];
    std::ranges::copy(history_->core(id), scratch.cores_.data() + i * size);
    const auto ring = history_->stale_ring(id),
               ring_before = history_->stale_ring(sent_[probes[i]]);
    if (!ring.empty()) now.add(probes[i], ring);
    if (!ring_before.empty()) before.add(probes[i], ring_before);
  }
  if (!head.info.keyframe && !head.info.fresh) scratch.load(*history_, sent_);
  scratch.mirror_.set_stale(before);
  return scratch.writer_.write(scratch.mirror_, backend, head, {probes, scratch.cores_, now}, out);
}

void UpdateStream::commit(WrittenPacket& written) noexcept {
  for (const std::uint32_t probe : written.probes) {
    const BlockId id = history_->current()[source(probe)];
    history_->hold(id);
    written.replaced.emplace_back(probe, std::exchange(sent_[probe], id));
    moved_[probe] = 0;
  }
  if (keyframe_wanted_) {
    forget(written.replaced);  // Nothing before a keyframe can be gone back to.
  } else {
    log_.push_back(
        {chain_.sequence + 1, chain_.checksum, written.fresh, std::move(written.replaced)});
  }
  if (log_.size() > max_unacknowledged_) forget_log(log_.size() - max_unacknowledged_);
  keyframe_wanted_ = false;
  chain_.advance(written.packet);
}

void UpdateStream::set_moved(std::span<const std::uint32_t> probes) noexcept {
  for (const std::uint32_t probe : probes) moved_[probe] = 1;
}

std::uint64_t UpdateStream::state_hash() const {
  StateHash hash;
  for (std::uint32_t probe = 0; probe < sent_.size(); ++probe) {
    hash.add(probe, history_->core(sent_[probe]), history_->stale_ring(sent_[probe]));
  }
  return hash.value();
}

Status UpdateStream::snapshot(BackendEncoder& backend, StreamScratch& scratch, Packet& out) const {
  std::vector<std::uint32_t> probes;
  scratch.cores_.clear();
  StaleRings stale;
  for (std::uint32_t probe = 0; probe < sent_.size(); ++probe) {
    const BlockId id = sent_[probe];
    if (id == kZeroBlock) continue;
    probes.push_back(probe);
    const auto core = history_->core(id);
    scratch.cores_.insert(scratch.cores_.end(), core.begin(), core.end());
    if (const auto ring = history_->stale_ring(id); !ring.empty()) stale.add(probe, ring);
  }
  return scratch.writer_.write(scratch.mirror_, backend, chain_.snapshot(desc_),
                               {probes, scratch.cores_, stale}, out);
}

void UpdateStream::acknowledge(std::uint32_t sequence) noexcept {
  const auto later = [&](const Unacknowledged& packet) { return packet.sequence > sequence; };
  forget_log(static_cast<std::size_t>(std::ranges::find_if(log_, later) - log_.begin()));
}

bool UpdateStream::resume(std::uint32_t sequence, std::uint32_t checksum) noexcept {
  // The log's entries are consecutive and end with chain_.sequence.
  const bool known =
      sequence > 0 && sequence <= chain_.sequence && chain_.sequence - sequence <= log_.size() &&
      checksum == (sequence == chain_.sequence
                       ? chain_.checksum
                       : log_[log_.size() - (chain_.sequence - sequence)].checksum_before);
  if (!known) {
    request_keyframe();
    return false;
  }
  while (chain_.sequence > sequence) {
    Unacknowledged& last = log_.back();
    for (const auto& [probe, id] : last.replaced) {
      history_->release(std::exchange(sent_[probe], id));
      if (last.fresh) moved_[probe] = 1;
    }
    chain_.checksum = last.checksum_before;
    log_.pop_back();
    --chain_.sequence;
  }
  return true;
}

std::size_t UpdateStream::memory() const noexcept {
  std::size_t bytes = moved_.capacity() + sent_.capacity() * sizeof(BlockId) +
                      probes_.capacity() * sizeof(std::uint32_t);
  for (const auto& packet : log_) {
    bytes += sizeof packet + packet.replaced.capacity() * sizeof packet.replaced[0];
  }
  return bytes;
}

}  // namespace gicodec
