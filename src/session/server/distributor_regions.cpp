// The streams of regions: packets that move them on, and catch-ups and snapshots for clients that
// hold other states. Each packet is made once for all subscribers.
#include "base/guard.h"
#include "session/server/distributor_state.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gicodec {
namespace {

/// True if the streams hold contents that are no longer current, of inactive blocks or of blocks
/// that changed too little.
bool holds_earlier(const SharedRegion& shared) noexcept {
  return std::any_of(shared.streams.begin(), shared.streams.end(), [](const UpdateStream& stream) {
    for (std::uint32_t block = 0; block < stream.size(); ++block) {
      if (stream.sent(block) != kNothing && stream.differs(block)) return true;
    }
    return false;
  });
}

/// The blocks that clients in an earlier state lack in any texture; the packets of all textures
/// have these. Empty where that makes no difference.
BlockMask missing_of(const SharedRegion& shared, const Lagging* from,
                     std::span<const std::uint32_t> blocks) {
  BlockMask missing;
  if (from == nullptr || shared.streams.size() == 1) return missing;
  missing.resize(shared.streams[0].size());
  for (std::size_t i = 0; i < shared.streams.size(); ++i) {
    shared.streams[i].mark_missing(from->states[i], blocks, missing);
  }
  return missing;
}

}  // namespace

/// Moves all streams on, or none; then makes the catch-ups and the snapshot of other states.
Status Distributor::State::update_region(ServedVolume& volume, Bundle& bundle, std::uint32_t region,
                                         unsigned thread) {
  SharedRegion& shared = bundle.regions[region];
  shared.written = shared.written_for_few = 0;
  shared.costs = {};
  const auto served = [](const Lagging& lagging) { return lagging.subscribers.allotted; };
  if (shared.up_to_date.served == 0 && !shared.waiting.allotted &&
      std::none_of(shared.lagging.begin(), shared.lagging.end(), served)) {
    return Status::ok;
  }
  if (bundle.due) {
    std::vector<std::uint32_t> dependencies, with_earlier;
    if (shared.dependencies_changed) {
      const TextureGroup& group = volume.desc.groups[bundle.group->depends_on];
      dependencies = volume.dependencies[bundle.group_id].regions(
          bundle.region_blocks[region],
          regions_of(group.textures[0].desc, volume.described.region));
      std::set_union(dependencies.begin(), dependencies.end(), shared.dependencies.begin(),
                     shared.dependencies.end(), std::back_inserter(with_earlier));
    }
    const Status status = advance(volume, bundle, shared, thread);
    if (status != Status::ok) return status;
    shared.changed = 0;
    if (shared.dependencies_changed) {
      shared.dependencies_changed = holds_earlier(shared);
      shared.dependencies = std::move(shared.dependencies_changed ? with_earlier : dependencies);
    }
  }
  if (bundle.is_stateful || shared.streams[0].keyframe_next()) return Status::ok;
  Status first = Status::ok;
  const auto note = [&first](Status status) {
    if (first == Status::ok) first = status;
  };
  const auto make_up = [&](const Lagging* from, SubscriberGroup& subscribers) {
    if (!subscribers.allotted || !subscribers.packets.empty()) return;
    std::vector<Written> written;
    note(guarded(
        [&] { return write(bundle, shared, from, nullptr, thread, written, subscribers); }));
  };
  for (Lagging& lagging : shared.lagging) make_up(&lagging, lagging.subscribers);
  make_up(nullptr, shared.waiting);
  return first;
}

/// Active blocks of a region whose current contents its streams do not hold.
std::vector<std::uint32_t> Distributor::State::outdated_blocks(const ServedVolume& volume,
                                                               const Bundle& bundle,
                                                               const SharedRegion& shared) const {
  std::vector<std::uint32_t> blocks;
  for (std::uint32_t block = 0; block < shared.streams[0].size(); ++block) {
    if (!volume.is_active(bundle.group_id, shared.streams[0].volume_block(block))) continue;
    if (bundle.outdated(shared.streams, block)) blocks.push_back(block);
  }
  return blocks;
}

/// Makes the packets of all textures for clients in the state `from`, or in none if null. They move
/// the client on to the blocks `next`, or, if null, to the streams' state.
Status Distributor::State::write(const Bundle& bundle, SharedRegion& shared, const Lagging* from,
                                 const std::vector<std::uint32_t>* next, unsigned thread,
                                 std::vector<Written>& written, SubscriberGroup& subscribers) {
  std::vector<SharedPacket> packets;
  const auto blocks = next == nullptr ? std::span<const std::uint32_t>() : std::span(*next);
  const BlockMask missing = missing_of(shared, from, blocks);
  const double share = static_cast<double>(subscribers.served) / shared_clients;
  written.resize(shared.streams.size());
  for (std::size_t i = 0; i < shared.streams.size(); ++i) {
    const UpdateStream& stream = shared.streams[i];
    const StreamState* const held = from == nullptr ? nullptr : &from->states[i];
    const auto found = encoder(thread, *bundle.textures[i], stream, shared.encoders[i].get(),
                               shared_preset.preset());
    if (!found) return found.status();
    PacketWriter& writer = workers[thread].writer;
    const Status status =
        next == nullptr ? stream.catch_up(held, missing, **found, writer, written[i])
                        : stream.write_from(held, blocks, missing, **found, writer, written[i]);
    if (status != Status::ok) return status;
    for (WrittenPacket& one : written[i].packets()) {
      const auto count = static_cast<std::uint32_t>(one.contents.blocks.size());
      if (bundle.textures[i]->options.chooses_preset) {
        shared.costs.add(stream.desc(), count, one.packet.size(), shared_preset.preset(), share);
      }
      packets.push_back({bundle.textures[i]->id, one.sequence, is_keyframe(one.type),
                         std::make_shared<const Packet>(std::move(one.packet)), count});
    }
  }
  for (const SharedPacket& packet : packets) {
    shared.written += packet.blocks;
    if (next == nullptr) shared.written_for_few += packet.blocks;
  }
  subscribers.packets = std::move(packets);
  return Status::ok;
}

/// Moves the streams on to the changed blocks by packets for one group of subscribers: those up to
/// date, else lagging ones with time for a catch-up, else waiting ones. Other subscribers of the
/// streams' state then lag.
Status Distributor::State::advance(const ServedVolume& volume, const Bundle& bundle,
                                   SharedRegion& shared, unsigned thread) {
  const auto anybody = [](const Lagging& lagging) { return lagging.subscribers.all > 0; };
  if (shared.up_to_date.all == 0 &&
      std::none_of(shared.lagging.begin(), shared.lagging.end(), anybody)) {
    for (UpdateStream& stream : shared.streams) stream.request_keyframe();
  }
  if (bundle.is_stateful && shared.waiting.allotted) {
    for (UpdateStream& stream : shared.streams) stream.request_keyframe();
  }
  const bool known = !shared.streams[0].keyframe_next();
  const auto blocks = outdated_blocks(volume, bundle, shared);
  if (blocks.empty() && known) return Status::ok;

  // Allocates first, so that nothing can fail once there are packets.
  if (known) {
    Lagging before{
        .states = {}, .last_current = shared.last_current(updates - 1), .subscribers = {}};
    before.subscribers.served = shared.up_to_date.served;
    for (const UpdateStream& stream : shared.streams) before.states.push_back(stream.state());
    shared.lagging.push_back(std::move(before));
  }
  const auto needs_some = [](const Lagging& one) { return one.subscribers.allotted; };
  auto from = shared.lagging.end();
  if (known && shared.up_to_date.served > 0) {
    --from;
  } else if (known) {
    from = std::find_if(shared.lagging.begin(), shared.lagging.end(), needs_some);
  }
  const bool waiting = from == shared.lagging.end();
  std::vector<Written> written;
  const Status status = guarded([&] {
    return write(bundle, shared, waiting ? nullptr : &*from, &blocks, thread, written,
                 waiting ? shared.waiting : from->subscribers);
  });
  if (status != Status::ok) {
    if (known) shared.lagging.pop_back();
    // Stateful encoders have seen blocks that nobody gets.
    if (bundle.is_stateful) {
      for (UpdateStream& stream : shared.streams) stream.request_keyframe();
    }
    return status;
  }
  if (known) shared.lagging.back().subscribers.all = std::exchange(shared.up_to_date.all, 0);
  if (!known) shared.keyframe_turn = bundle.turn(updates);
  for (std::size_t i = 0; i < written.size(); ++i) shared.streams[i].commit(written[i]);
  return Status::ok;
}

}  // namespace gicodec
