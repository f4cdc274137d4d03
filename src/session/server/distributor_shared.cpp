// Packets of regions, made once for all who subscribe. Who comes late gets a snapshot, who takes
// fewer updates than others gets catch-ups, and then the same packets as everybody.
#include "base/guard.h"
#include "session/server/distributor_state.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gicodec {
namespace {

/// States of a region that are kept for those who are behind.
constexpr std::size_t kMaxBehind = 12;
/// Catch-ups of a region in one update: as many as four groups at all rates need on average, and
/// some.
constexpr std::size_t kMaxCatchUps = 4;
/// An update may be so much larger than the budget, which counts on average.
constexpr float kBurst = 2;

/// True if the receiver of these joins, one per texture, holds the given states.
bool holds(std::span<const Join> joins, std::span<const StreamState> states) noexcept {
  return std::equal(joins.begin(), joins.end(), states.begin(), states.end(),
                    [](const Join& join, const StreamState& state) {
                      return state.is(join.sequence, join.checksum);
                    });
}

/// True if it holds what the streams sent last.
bool is_current(const SharedRegion& shared, std::span<const Join> joins) noexcept {
  return std::equal(joins.begin(), joins.end(), shared.streams.begin(), shared.streams.end(),
                    [](const Join& join, const UpdateStream& stream) {
                      return !stream.keyframe_next() &&
                             stream.state().is(join.sequence, join.checksum);
                    });
}

template <typename Shared>
auto find_behind(Shared& shared, std::span<const Join> joins) noexcept {
  return std::find_if(shared.behind.begin(), shared.behind.end(),
                      [&](const Behind& one) { return holds(joins, one.states); });
}

/// True if the streams keep contents that are no longer current: of blocks that are not active, or
/// that changed too little.
bool holds_earlier(const SharedRegion& shared) noexcept {
  return std::any_of(shared.streams.begin(), shared.streams.end(), [](const UpdateStream& stream) {
    for (std::uint32_t block = 0; block < stream.size(); ++block) {
      if (stream.sent(block) != kNothing && stream.differs(block)) return true;
    }
    return false;
  });
}

Audience& audience_of(SharedRegion& shared, std::span<const Join> joins) noexcept {
  if (is_current(shared, joins)) return shared.up_to_date;
  const auto behind = find_behind(shared, joins);
  return behind != shared.behind.end() ? behind->audience : shared.waiting;
}

/// What those who hold an earlier state lack in any texture, so that it comes in all of them;
/// nothing where that makes no difference.
BlockMask lacking_of(const SharedRegion& shared, const Behind* from,
                     std::span<const std::uint32_t> blocks) {
  BlockMask lacking;
  if (from == nullptr || shared.streams.size() == 1) return lacking;
  lacking.resize(shared.streams[0].size());
  for (std::size_t i = 0; i < shared.streams.size(); ++i) {
    shared.streams[i].mark_lacking(from->states[i], blocks, lacking);
  }
  return lacking;
}

/// A number below `count` that is another one in every update, and evenly spread over some.
std::size_t spread(std::uint64_t update, std::size_t count) noexcept {
  constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15;
  return count == 0 ? 0 : (update * kGolden >> 32) % count;
}

}  // namespace

/// Every region that a client subscribes to: visit(volume, lot, region, place, joins, shared).
template <typename Visit>
void Distributor::State::for_each_join(ServedClient& client, const Visit& visit) noexcept {
  std::size_t place = 0;
  for (const auto& volume : volumes) {
    for (std::size_t l = 0; l < volume->lots.size(); ++l) {
      Lot& lot = *volume->lots[l];
      for (std::uint32_t region = 0; region < lot.regions.size(); ++region, ++place) {
        const auto joins = client.joins_of(volume->id(), l, lot, region);
        if (joins[0].subscribed) visit(*volume, lot, region, place, joins, lot.regions[region]);
      }
    }
  }
}

/// Before an update: who takes part in it, and what they hold.
void Distributor::State::gather_audiences() noexcept {
  for (const auto& entry : clients) {
    ServedClient& client = *entry.second;
    if (client.delivery != Delivery::shared) continue;
    std::size_t regions = 0, bytes = 0;
    for_each_join(client, [&](const ServedVolume&, const Lot&, std::uint32_t, std::size_t,
                              std::span<const Join>, const SharedRegion& shared) {
      ++regions;
      bytes += shared.bytes;
    });
    client.rate.choose(client.budget, regions, bytes / std::max<std::size_t>(regions, 1));
    for_each_join(client, [&](const ServedVolume&, const Lot& lot, std::uint32_t, std::size_t place,
                              std::span<const Join> joins, SharedRegion& shared) {
      Audience& audience = audience_of(shared, joins);
      ++audience.all;
      if (!client.suspended && client.rate.turn(lot.turn(updates), place)) ++audience.served;
    });
  }
}

/// Which snapshots and catch-ups there is time for: the oldest first, of regions in an order that
/// is another one in every update.
void Distributor::State::allot_extras() noexcept {
  std::size_t regions = 0;
  for_each_region([&](auto&&...) { ++regions; });
  const std::size_t start = spread(updates, regions);
  std::uint64_t left = extra_blocks == 0 ? UINT64_MAX : extra_blocks;
  const auto allot = [&](Audience& audience, std::uint64_t blocks) {
    if (audience.served == 0 || left == 0) return false;
    left -= std::min(left, blocks);
    return audience.extra = true;
  };
  for (const bool wrapped : {false, true}) {
    std::size_t place = 0;
    for_each_region([&](const ServedVolume&, const Lot& lot, SharedRegion& shared) {
      if ((place++ < start) != wrapped) return;
      const std::uint64_t blocks = std::uint64_t{shared.streams[0].size()} * lot.textures.size();
      std::size_t catch_ups = 0;
      for (Behind& behind : shared.behind) {
        if (catch_ups < kMaxCatchUps && allot(behind.audience, blocks)) ++catch_ups;
      }
      allot(shared.waiting, blocks);
    });
  }
}

/// Moves the streams on, or not at all; then makes what others need to follow them.
Status Distributor::State::update_region(ServedVolume& volume, Lot& lot, std::uint32_t region,
                                         unsigned thread) {
  SharedRegion& shared = lot.regions[region];
  shared.written = shared.extra = 0;
  const auto served = [](const Behind& behind) { return behind.audience.extra; };
  if (shared.up_to_date.served == 0 && !shared.waiting.extra &&
      std::none_of(shared.behind.begin(), shared.behind.end(), served)) {
    return Status::ok;
  }
  if (lot.due) {
    std::vector<std::uint32_t> named, with_earlier;
    if (shared.renamed) {
      const TextureGroup& group = volume.desc.groups[lot.group->depends_on];
      named = volume.names[lot.group_id].regions(
          lot.region_blocks[region], regions_of(group.textures[0].desc, volume.described.region));
      std::set_union(named.begin(), named.end(), shared.named.begin(), shared.named.end(),
                     std::back_inserter(with_earlier));
    }
    const Status status = advance(volume, lot, shared, thread);
    if (status != Status::ok) return status;
    shared.changed = 0;
    if (shared.renamed) {
      shared.renamed = holds_earlier(shared);
      shared.named = std::move(shared.renamed ? with_earlier : named);
    }
  }
  if (shared.streams[0].keyframe_next()) return Status::ok;
  Status first = Status::ok;
  const auto note = [&first](Status status) {
    if (first == Status::ok) first = status;
  };
  const auto make_up = [&](const Behind* from, Audience& audience) {
    if (!audience.extra || !audience.packets.empty()) return;
    std::vector<Written> written;
    note(guarded([&] { return write(lot, shared, from, nullptr, thread, written, audience); }));
  };
  for (Behind& behind : shared.behind) make_up(&behind, behind.audience);
  make_up(nullptr, shared.waiting);
  return first;
}

/// Active blocks of a region that its streams do not hold as they are.
std::vector<std::uint32_t> Distributor::State::outdated_blocks(const ServedVolume& volume,
                                                               const Lot& lot,
                                                               const SharedRegion& shared) const {
  std::vector<std::uint32_t> blocks;
  for (std::uint32_t block = 0; block < shared.streams[0].size(); ++block) {
    if (!volume.is_active(lot.group_id, shared.streams[0].source(block))) continue;
    if (lot.outdated(shared.streams, block)) blocks.push_back(block);
  }
  return blocks;
}

std::uint32_t Distributor::missing(ClientId client) const noexcept {
  ServedClient* const found = state_->find(client);
  if (found == nullptr || found->delivery != Delivery::shared) return 0;
  std::uint32_t blocks = 0;
  const auto count = [&](const ServedVolume& volume, const Lot& lot, std::uint32_t, std::size_t,
                         std::span<const Join> joins, SharedRegion& shared) {
    const bool all = !is_current(shared, joins);
    for (std::uint32_t block = 0; block < shared.streams[0].size(); ++block) {
      if (!volume.is_active(lot.group_id, shared.streams[0].source(block))) continue;
      if (all || lot.outdated(shared.streams, block)) ++blocks;
    }
  };
  state_->for_each_join(*found, count);
  return blocks;
}

/// Packets in all textures for those who hold an earlier state, or nothing: those that move the
/// streams on to `next`, or, if that is null, to where the streams are.
Status Distributor::State::write(const Lot& lot, SharedRegion& shared, const Behind* from,
                                 const std::vector<std::uint32_t>* next, unsigned thread,
                                 std::vector<Written>& written, Audience& audience) {
  std::vector<SharedPacket> packets;
  const auto blocks = next == nullptr ? std::span<const std::uint32_t>() : std::span(*next);
  const BlockMask together = lacking_of(shared, from, blocks);
  written.resize(shared.streams.size());
  for (std::size_t i = 0; i < shared.streams.size(); ++i) {
    const UpdateStream& stream = shared.streams[i];
    const StreamState* const held = from == nullptr ? nullptr : &from->states[i];
    const auto found = worker(thread, stream.desc());
    if (!found) return found.status();
    BackendEncoder& encoder = *(*found)->encoder;
    PacketWriter& writer = (*found)->writer;
    const Status status =
        next == nullptr ? stream.catch_up(held, together, encoder, writer, written[i])
                        : stream.write_from(held, blocks, together, encoder, writer, written[i]);
    if (status != Status::ok) return status;
    for (WrittenPacket& one : written[i].packets()) {
      const auto count = static_cast<std::uint32_t>(one.contents.blocks.size());
      packets.push_back({lot.textures[i]->id, one.sequence, is_keyframe(one.type),
                         std::make_shared<const Packet>(std::move(one.packet)), count});
    }
  }
  for (const SharedPacket& packet : packets) {
    shared.written += packet.blocks;
    if (next == nullptr) shared.extra += packet.blocks;
  }
  audience.packets = std::move(packets);
  return Status::ok;
}

/// Moves the streams on to what changed, by packets for those who need some anyway: who is up to
/// date, else some of those who are behind, else those who wait. Who held the state before is
/// behind then.
Status Distributor::State::advance(const ServedVolume& volume, const Lot& lot, SharedRegion& shared,
                                   unsigned thread) {
  const auto anybody = [](const Behind& behind) { return behind.audience.all > 0; };
  if (shared.up_to_date.all == 0 &&
      std::none_of(shared.behind.begin(), shared.behind.end(), anybody)) {
    for (UpdateStream& stream : shared.streams) stream.request_keyframe();
  }
  const bool known = !shared.streams[0].keyframe_next();
  const auto blocks = outdated_blocks(volume, lot, shared);
  if (blocks.empty() && known) return Status::ok;

  // Room first, so that nothing can fail once there are packets.
  if (known) {
    Behind before{.states = {}, .until = shared.until(updates - 1), .audience = {}};
    for (const UpdateStream& stream : shared.streams) before.states.push_back(stream.state());
    shared.behind.push_back(std::move(before));
  }
  const auto needs_some = [](const Behind& one) { return one.audience.extra; };
  auto from = shared.behind.end();
  if (shared.up_to_date.served > 0) {
    --from;
  } else if (known) {
    from = std::find_if(shared.behind.begin(), shared.behind.end(), needs_some);
  }
  const bool waiting = from == shared.behind.end();
  std::vector<Written> written;
  const Status status = guarded([&] {
    return write(lot, shared, waiting ? nullptr : &*from, &blocks, thread, written,
                 waiting ? shared.waiting : from->audience);
  });
  if (status != Status::ok) {
    if (known) shared.behind.pop_back();
    return status;
  }
  if (known) shared.behind.back().audience.all = std::exchange(shared.up_to_date.all, 0);
  for (std::size_t i = 0; i < written.size(); ++i) shared.streams[i].commit(written[i]);
  return Status::ok;
}

/// True if, of all that the blocks of a region name, the client holds what was current since it
/// does not hold what is current of that region.
bool Distributor::State::holds_all_named(ServedClient& client, const ServedVolume& volume,
                                         const Lot& lot, const SharedRegion& naming,
                                         std::span<const Join> joins) const noexcept {
  if (naming.named.empty()) return true;
  const auto since = find_behind(naming, joins);
  const std::uint32_t first = since == naming.behind.end() ? joins[0].since : since->until + 1;
  const auto is_recent = [&](const SharedRegion& shared, std::span<const Join> held) {
    if (is_current(shared, held)) return shared.until(updates) >= first;
    const auto behind = find_behind(shared, held);
    return behind != shared.behind.end() && behind->until >= first;
  };
  for (std::size_t l = 0; l < volume.lots.size(); ++l) {
    const Lot& other = *volume.lots[l];
    if (!lot.names(other)) continue;
    for (const std::uint32_t region : naming.named) {
      const auto held = client.joins_of(volume.id(), l, other, region);
      if (!is_recent(other.regions[region], held)) return false;
    }
  }
  return true;
}

/// After all regions are made: one thread. Who cannot be handed what was made holds what he held.
Status Distributor::State::hand_out_regions(ServedClient& client) noexcept {
  client.held_back = client.rate.slowed();
  if (client.suspended) return Status::ok;
  std::size_t packets = 0, places = 0;
  for_each_join(client, [&](const ServedVolume&, const Lot& lot, std::uint32_t, std::size_t place,
                            std::span<const Join> joins, SharedRegion& shared) {
    places = place + 1;
    if (!client.rate.turn(lot.turn(updates), place)) return;
    packets += audience_of(shared, joins).packets.size();
  });
  const Status room = guarded([&]() -> Status {
    client.out.reserve(packets);
    return Status::ok;
  });
  if (room != Status::ok) return room;
  const double most =
      client.budget.bytes == 0 ? 1e18 : kBurst * static_cast<double>(client.budget.bytes);
  // Where there is no room for all, others come first in every update.
  const std::size_t start = client.rate.slowed() ? spread(updates, places) : 0;
  std::size_t turns = 0, bytes = 0, blocks = 0;
  for (const bool wrapped : {false, true}) {
    if (wrapped && start == 0) break;
    for_each_join(client, [&](const ServedVolume& volume, const Lot& lot, std::uint32_t region,
                              std::size_t place, std::span<Join> joins, SharedRegion& shared) {
      if ((place < start) != wrapped || !client.rate.turn(lot.turn(updates), place)) return;
      ++turns;
      Audience& audience = audience_of(shared, joins);
      if (audience.packets.empty()) return;
      std::size_t size = 0;
      for (const SharedPacket& one : audience.packets) size += one.packet->size();
      const bool full = bytes > 0 && static_cast<double>(bytes + size) > most;
      if (full || !holds_all_named(client, volume, lot, shared, joins)) {
        client.held_back = true;
        return;
      }
      bytes += size;
      const auto tier = static_cast<std::uint8_t>(client.rate.tier(place));
      for (const SharedPacket& one : audience.packets) {
        client.out.push_back({{volume.id(), one.texture, region},
                              tier,
                              one.blocks,
                              one.sequence,
                              one.keyframe,
                              one.packet});
        blocks += one.blocks;
      }
      for (std::size_t i = 0; i < joins.size(); ++i) {
        joins[i].sequence = shared.streams[i].sequence();
        joins[i].checksum = shared.streams[i].checksum();
      }
      --audience.all;
    });
  }
  if (start > 0) {
    std::stable_sort(
        client.out.begin(), client.out.end(),
        [](const OutgoingPacket& a, const OutgoingPacket& b) { return a.stream < b.stream; });
  }
  client.rate.sent(turns, bytes, blocks);
  return Status::ok;
}

/// After an update: states that nobody holds any more, and more than are kept; packets; who took
/// part.
void Distributor::State::forget_audiences() noexcept {
  const auto fewer = [](const Behind& a, const Behind& b) {
    return a.audience.all < b.audience.all;
  };
  const auto nobody = [](const Behind& one) { return one.audience.all == 0; };
  for_each_region([&](const ServedVolume&, const Lot&, SharedRegion& shared) {
    auto& behind = shared.behind;
    behind.erase(std::remove_if(behind.begin(), behind.end(), nobody), behind.end());
    // The oldest of those that fewest hold: they get snapshots.
    if (behind.size() > kMaxBehind) {
      behind.erase(std::min_element(behind.begin(), behind.end(), fewer));
    }
    for (Behind& one : behind) one.audience = {};
    shared.up_to_date = shared.waiting = {};
  });
}

const StreamState* Distributor::State::held_of_region(ServedClient& client,
                                                      StreamId id) const noexcept {
  const auto joins = find_joins(client, id);
  if (joins.empty()) return nullptr;
  const TexturePlace at = find(id.volume, id.texture);
  const SharedRegion& shared = at.lot->regions[id.region];
  if (is_current(shared, joins)) return &shared.streams[at.place].state();
  const auto behind = find_behind(shared, joins);
  return behind == shared.behind.end() ? nullptr : &behind->states[at.place];
}

}  // namespace gicodec
