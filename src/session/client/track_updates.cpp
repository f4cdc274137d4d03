// The objects of tracks that have come → updates for the client.
#include "base/guard.h"
#include "bitstream/packet.h"
#include "session/client/track_receiver_state.h"

#include <algorithm>
#include <map>
#include <utility>

namespace gicodec {
namespace {

/// Bytes of packets in one update to the client, unless one object is larger.
constexpr std::size_t kUpdateBytes = std::size_t{16} << 20;
/// The client puts it into its next Hello, which begins anew all the same.
constexpr Ticket kTicket{std::byte{1}};

/// True if an object after `held` applies to the state as of that update: the track did not change
/// between `previous` and the object.
bool builds_on(const TrackObject& object, std::uint64_t held) noexcept {
  return object.previous != 0 && object.previous <= held;
}

}  // namespace

LastObject last_object(const TrackTick& tick, StreamId stream) noexcept {
  const auto after = [](StreamId id, const TrackRun& run) { return id < run.first; };
  auto run = std::upper_bound(tick.changed.begin(), tick.changed.end(), stream, after);
  if (run == tick.changed.begin()) return {};
  --run;
  const bool holds = run->first.volume == stream.volume && run->first.texture == stream.texture &&
                     stream.region - run->first.region < run->count;
  return holds ? LastObject{tick.update - run->age, run->number} : LastObject{};
}

/// The update of the last object that can be applied after `from`, none later than `last`.
std::uint64_t TrackReceiver::State::reach_from(const Track& track, std::uint64_t from,
                                               std::uint64_t last) noexcept {
  for (auto it = track.updates.upper_bound(from); it != track.updates.end() && it->first <= last;
       ++it) {
    if (builds_on(it->second.object, from)) from = it->first;
  }
  return from;
}

/// True if a track that ends with this update has all that the tick tells of.
bool TrackReceiver::State::has_all(const TrackTick& as_of, const Track& track,
                                   std::uint64_t end) const noexcept {
  if (const std::uint64_t changed = last_object(as_of, track.stream).update; changed != 0)
    return end >= changed;
  // It has not changed since the round.
  if (track.confirmed >= as_of.round && track.confirmed != 0 && end >= track.last) return true;
  return table->list().round >= as_of.round && end >= track.snapshot;
}

/// Notes which tracks were whole as of an earlier tick, with what waits.
void TrackReceiver::State::confirm(const TrackTick& as_of) noexcept {
  for (TrackUnit& unit : table->units()) {
    if (!unit.wanted) continue;
    for (Track& track : unit.tracks) {
      if (track.at == 0) continue;
      const std::uint64_t end = reach_from(track, track.at, as_of.update);
      if (has_all(as_of, track, end)) track.confirmed = as_of.update, track.last = end;
    }
  }
}

TrackWay TrackReceiver::State::way_of(const Track& track) const noexcept {
  const TrackWay held{track.at == 0 ? 0 : reach_from(track, track.at, tick->update), false};
  if (has_all(*tick, track, held.end) || !track.newest_snapshot) return held;
  const std::uint64_t snapshot = track.newest_snapshot->object.update;
  if (snapshot <= held.end || snapshot > tick->update) return held;
  return {reach_from(track, snapshot, tick->update), true};
}

/// A packet is read with the presence of its update. Where presence goes by its snapshot, what it
/// was before is unknown, and the other tracks need snapshots, too. False if they lack them.
bool TrackReceiver::State::follow_presence(const TrackUnit& unit,
                                           std::vector<TrackWay>& ways) const noexcept {
  if (std::none_of(ways.begin(), ways.end(), [](const TrackWay& way) { return way.by_snapshot; }))
    return true;
  for (std::size_t t = 0; t < ways.size(); ++t) {
    const Track& track = unit.tracks[t];
    const auto presence = table->presence_of(track.stream);
    if (!presence || !ways[*presence].by_snapshot || ways[t].end == track.at) continue;
    const std::uint64_t known = unit.tracks[*presence].newest_snapshot->object.update;
    const std::uint64_t snapshot = track.newest_snapshot ? track.newest_snapshot->object.update : 0;
    const auto next = track.updates.upper_bound(track.at);
    const bool follows = ways[t].by_snapshot ? snapshot >= known
                                             : next == track.updates.end() || next->first >= known;
    if (follows) continue;
    if (snapshot < known || snapshot > tick->update) return false;
    ways[t] = {reach_from(track, snapshot, tick->update), true};
  }
  return true;
}

void TrackReceiver::State::add_steps(Track& track, const TrackWay& way,
                                     std::vector<TrackStep>& steps) const {
  std::uint64_t at = track.at;
  if (way.by_snapshot) {
    at = track.newest_snapshot->object.update;
    steps.push_back({&track, &*track.newest_snapshot});
  }
  for (auto it = track.updates.upper_bound(at); it != track.updates.end() && it->first <= way.end;
       ++it) {
    if (!builds_on(it->second.object, at)) continue;
    at = it->first;
    steps.push_back({&track, &it->second});
  }
}

Status TrackReceiver::State::write(std::span<const TrackStep> steps, std::vector<Message>& out) {
  UpdateMessage update{
      *sync, number + 1, table->list().generation, tick->update, tick->time, tick->scrolls, {}, {}};
  std::map<StreamId, std::uint64_t> proofs;
  for (const TrackStep& step : steps) {
    const TrackObject& object = step.waiting->object;
    for (const auto packet : object.packets) update.parts.push_back({object.stream, 0, packet});
    proofs.erase(object.stream);
    if (!object.proof.empty()) proofs.emplace(object.stream, object.proof.front());
  }
  for (const auto& [stream, hash] : proofs) update.proofs.push_back({stream, hash});
  Message bytes;
  const Status status = write_message(update, bytes);
  if (status != Status::ok) return status;
  out.push_back(std::move(bytes));
  ++number;
  return Status::ok;
}

/// Makes the updates that take the client to the tick, as far as what has come allows.
Status TrackReceiver::State::advance(std::vector<Message>& out) {
  std::vector<TrackStep> steps;
  std::vector<std::pair<TrackUnit*, std::vector<TrackWay>>> forward;
  all = true;
  for (TrackUnit& unit : table->units()) {
    if (!unit.wanted) continue;
    std::vector<TrackWay> ways;
    for (const Track& track : unit.tracks) ways.push_back(way_of(track));
    bool has = follow_presence(unit, ways);
    for (std::size_t t = 0; t < ways.size(); ++t)
      has = has && has_all(*tick, unit.tracks[t], ways[t].end);
    if (!has) {
      all = false;
      if (!new_tick) continue;
      ++unit.behind;
      std::uint32_t patience = kFirstPatience;
      while (patience < kLastPatience && unit.behind > patience) patience *= 2;
      for (Track& track : unit.tracks) track.asks = track.asks || unit.behind % patience == 0;
      continue;
    }
    for (std::size_t t = 0; t < ways.size(); ++t) add_steps(unit.tracks[t], ways[t], steps);
    forward.emplace_back(&unit, std::move(ways));
  }
  const bool waits = !all && !begun && ticks - ticks_before < kFirstTicks;
  if (!welcomed || waits) {
    new_tick = has_news = false, rounds = 0;
    return Status::ok;
  }
  std::stable_sort(steps.begin(), steps.end(), [](const TrackStep& a, const TrackStep& b) {
    return std::pair(a.waiting->object.update, a.track->stream) <
           std::pair(b.waiting->object.update, b.track->stream);
  });
  for (std::size_t first = 0; first < steps.size() || (first == 0 && new_tick);) {
    std::size_t end = first, bytes = 0;
    while (end < steps.size() && (end == first || bytes < kUpdateBytes))
      bytes += steps[end++].waiting->bytes.size();
    const Status written = write(std::span(steps).subspan(first, end - first), out);
    if (written != Status::ok) return written;
    if (end == first) break;
    first = end;
  }
  // From here on nothing can fail.
  for (const TrackStep& step : steps) {
    const auto parts = parse_packet(step.waiting->object.packets.back());
    step.track->number = step.waiting->object.number;
    step.track->sent = {};
    if (parts) {
      const auto packet = step.waiting->object.packets.back();
      step.track->sent = {step.track->stream, parts->info.sequence, checksum_after(*parts, packet)};
    }
  }
  for (const auto& [unit, ways] : forward) {
    unit->behind = 0;
    for (std::size_t t = 0; t < ways.size(); ++t) {
      Track& track = unit->tracks[t];
      track.asks = false;
      track.at = ways[t].end;
      track.confirmed = tick->update;
      track.last = track.at;
      if (track.newest_snapshot && track.newest_snapshot->object.update <= track.at) {
        waiting_bytes -= memory_of(*track.newest_snapshot);
        track.newest_snapshot.reset();
      }
      while (!track.updates.empty() && track.updates.begin()->first <= track.at) {
        waiting_bytes -= memory_of(track.updates.begin()->second);
        track.updates.erase(track.updates.begin());
      }
    }
  }
  new_tick = has_news = false, rounds = 0;
  begun = true;
  return Status::ok;
}

Status TrackReceiver::State::welcome(std::vector<Message>& out) {
  const TrackList& list = table->list();
  Message bytes;
  const Status written = write_message(Welcome{*sync, kTicket, false, Delivery::shared, list.epoch,
                                               list.scene, list.generation, list.volumes},
                                       bytes);
  if (written != Status::ok) return written;
  out.push_back(std::move(bytes));
  welcomed = true;
  return Status::ok;
}

Result<std::vector<Message>> TrackReceiver::take_messages() {
  return guarded([&]() -> Result<std::vector<Message>> {
    State& s = *state_;
    std::vector<Message> out;
    if (!s.sync || !s.table || !s.has_news) return out;
    const bool welcomed = s.welcomed;
    const std::uint32_t number = s.number;
    const Status made = guarded([&]() -> Status {
      if (!welcomed && !s.restarts) {
        const Status status = s.welcome(out);
        if (status != Status::ok) return status;
      }
      return s.tick ? s.advance(out) : Status::ok;
    });
    if (made == Status::ok) return out;
    // All of it is made again.
    s.welcomed = welcomed;
    s.number = number;
    return made;
  });
}

}  // namespace gicodec
