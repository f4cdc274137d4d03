// Publishes tracks: one client of the distributor gets the updates of all tracks, and now and then
// a second one joins to get their snapshots.
#include <gicodec/track_publisher.h>

#include "base/guard.h"
#include "base/memory.h"
#include "session/server/server_state.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace gicodec {
namespace {

/// Objects after a snapshot, at most: a receiver that comes late fetches each of them.
constexpr std::uint32_t kMaxObjects = 250;

/// What was published of a track.
struct Track {
  std::uint64_t changed = 0;         ///< update of the last object
  std::uint64_t snapshot = 0;        ///< update of the last snapshot; 0: none
  std::uint64_t snapshot_bytes = 0;  ///< its size
  std::uint64_t bytes = 0;           ///< of the objects after it
  std::uint32_t number = 0;          ///< of these objects

  [[nodiscard]] bool is_dirty() const noexcept { return changed > snapshot; }
};

using Packets = std::map<StreamId, std::vector<std::span<const std::byte>>>;

Packets by_stream(std::span<const OutgoingPacket> packets) {
  Packets all;
  for (const OutgoingPacket& one : packets) all[one.stream].push_back(*one.packet);
  return all;
}

/// Adds a track to runs that ascend.
void add_to(std::vector<TrackRun>& runs, const StreamId& stream, std::uint64_t age,
            std::uint32_t number) {
  if (!runs.empty()) {
    TrackRun& last = runs.back();
    StreamId next = last.first;
    next.region += last.count;
    if (next == stream && last.age == age && last.number == number) {
      ++last.count;
      return;
    }
  }
  runs.push_back({stream, 1, age, number});
}

}  // namespace

struct TrackPublisher::State {
  State(Server& server_in, const TrackOptions& options_in)
      : server(server_in), options(options_in) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    static_cast<void>(distributor().disconnect(all));
    static_cast<void>(distributor().disconnect(newcomer));
  }

  [[nodiscard]] Distributor& distributor() const noexcept { return server.state_->distributor; }
  [[nodiscard]] bool round_is_due(double now) const noexcept;
  void begin_round(double now);
  void end_round();
  void begin_again() noexcept;
  void forget_removed();
  void add_message(TrackMessage::Type type, const AnyMessage& message);
  void add_object(ClientId client, StreamId stream,
                  std::span<const std::span<const std::byte>> packets);
  void add_tick(double time);
  void add_list();

  Server& server;
  TrackOptions options;
  ClientId all = 0;       ///< gets the updates
  ClientId newcomer = 0;  ///< gets the snapshots of this round; 0: there is none
  std::map<StreamId, Track> tracks;
  std::map<StreamId, bool> awaited;  ///< snapshots of this round: true once it came
  bool first = true;                 ///< the first round, of all tracks
  std::uint32_t generation = 0;      ///< of the last list; 0: there was none
  std::uint64_t round_began = 0;     ///< the last update before this round
  std::uint64_t round = 0;           ///< that of the last round that ended
  double round_at = 0;               ///< when the last round began
  double stretch = 1;                ///< of the interval
  std::vector<TrackMessage> messages;
  TrackStatistics statistics;
};

TrackPublisher::TrackPublisher(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
TrackPublisher::TrackPublisher(TrackPublisher&&) noexcept = default;
TrackPublisher& TrackPublisher::operator=(TrackPublisher&&) noexcept = default;
TrackPublisher::~TrackPublisher() = default;

Result<TrackPublisher> TrackPublisher::create(Server& server, const TrackOptions& options) {
  return guarded([&]() -> Result<TrackPublisher> {
    if (!(options.snapshot_seconds > 0) || !std::isfinite(options.snapshot_seconds) ||
        !(options.snapshot_share > 0) || !(options.snapshot_share < 1)) {
      return Status::invalid_argument;
    }
    auto state = std::make_unique<State>(server, options);
    const auto all = state->distributor().connect(Delivery::shared);
    if (!all) return all.status();
    state->all = *all;
    return TrackPublisher(std::move(state));
  });
}

/// Snapshots are due if the objects after the last ones have taken so many bytes that the share
/// is kept, or if the interval is over.
bool TrackPublisher::State::round_is_due(double now) const noexcept {
  if (newcomer != 0) return false;
  if (first) return true;
  std::uint64_t snapshots = 0, objects = 0;
  bool any = false, none_yet = false, many = false;
  for (const auto& [stream, track] : tracks) {
    if (!track.is_dirty()) continue;
    any = true;
    none_yet = none_yet || track.snapshot == 0;
    many = many || track.number >= kMaxObjects;
    snapshots += track.snapshot_bytes;
    objects += track.bytes;
  }
  if (!any) return false;
  const double share = options.snapshot_share;
  const bool pays =
      static_cast<double>(objects) * share >= static_cast<double>(snapshots) * (1 - share);
  return none_yet || many || pays || now - round_at >= options.snapshot_seconds * stretch;
}

/// Lets a newcomer join that sees the tracks that have changed since their snapshots.
void TrackPublisher::State::begin_round(double now) {
  const auto joined = distributor().connect(Delivery::shared);
  if (!joined) return;  // the next update tries again
  newcomer = *joined;
  round_began = distributor().updates();
  const bool is_late = !first && now - round_at >= options.snapshot_seconds * stretch;
  stretch = std::clamp(is_late ? stretch * 2 : stretch / 2, 1.0, TrackOptions::kLongest);
  round_at = now;
  awaited.clear();
  for (const auto& [stream, track] : tracks) {
    if (track.is_dirty()) awaited.emplace(stream, false);
  }
  if (first) return;  // It sees everything.
  for (const auto& volume : distributor().table()) {
    if (volume->removed()) continue;
    for (std::uint8_t group = 0; group < volume->desc.groups.size(); ++group) {
      BlockMask seen(volume->blocks(group), 0);
      for (const auto& bundle : volume->bundles) {
        if (bundle->group_id != group) continue;
        for (std::uint32_t region = 0; region < bundle->regions.size(); ++region) {
          const bool wanted = std::any_of(
              bundle->textures.begin(), bundle->textures.end(), [&](const auto& texture) {
                return awaited.count({volume->id(), texture->id, region}) != 0;
              });
          if (!wanted) continue;
          for (const std::uint32_t block : bundle->region_blocks[region]) seen[block] = 1;
        }
      }
      static_cast<void>(distributor().set_visible(newcomer, volume->id(), seen, group));
    }
  }
}

/// Removes the newcomer once all snapshots have come.
void TrackPublisher::State::end_round() {
  if (newcomer == 0) return;
  if (std::any_of(awaited.begin(), awaited.end(), [](const auto& one) { return !one.second; }))
    return;
  static_cast<void>(distributor().disconnect(std::exchange(newcomer, 0)));
  if (awaited.empty()) return;  // There is nothing to publish yet.
  awaited.clear();
  first = false;
  round = round_began;
  add_list();
}

/// After packets that could not be published: all is published anew.
void TrackPublisher::State::begin_again() noexcept {
  if (!messages.empty() && messages.back().bytes.empty()) messages.pop_back();
  for (ClientId* const client : {&all, &newcomer})
    static_cast<void>(distributor().disconnect(std::exchange(*client, 0)));
  awaited.clear();
  first = true;
}

void TrackPublisher::State::forget_removed() {
  const auto table = distributor().table();
  const auto is_gone = [&](const auto& entry) {
    const auto& volume = *table[entry.first.volume];
    // A later volume of the number has other contents.
    return volume.removed() || volume.changed_in > generation;
  };
  std::erase_if(tracks, is_gone);
  std::erase_if(awaited, is_gone);
}

void TrackPublisher::State::add_message(TrackMessage::Type type, const AnyMessage& message) {
  TrackMessage& made = messages.emplace_back();
  made.type = type;
  const Status status = write_message(message, made.bytes);
  if (status == Status::out_of_memory) fail_allocation();
  if (type != TrackMessage::Type::object) statistics.other_bytes += made.bytes.size();
}

/// Adds an object of what a client gets; it is a snapshot if that is the newcomer.
void TrackPublisher::State::add_object(ClientId client, StreamId stream,
                                       std::span<const std::span<const std::byte>> packets) {
  Track& track = tracks[stream];
  const std::uint64_t update = distributor().updates();
  const bool is_snapshot = client == newcomer;
  TrackObject object{server.state_->options.epoch,
                     update,
                     is_snapshot ? 0 : std::exchange(track.changed, update),
                     is_snapshot ? 0 : ++track.number,
                     server.state_->generation,
                     stream,
                     {packets.begin(), packets.end()},
                     {}};
  if (server.state_->options.proofs) {
    if (const auto hash = distributor().state_hash(client, stream)) object.proof = {*hash};
  }
  add_message(TrackMessage::Type::object, object);
  TrackMessage& made = messages.back();
  made.stream = stream;
  made.number = object.number;
  const std::uint64_t bytes = made.bytes.size();
  if (is_snapshot) {
    track.snapshot = update;
    track.snapshot_bytes = bytes;
    track.bytes = 0;
    track.number = 0;
    ++statistics.snapshots;
    statistics.snapshot_bytes += bytes;
  } else {
    track.bytes += bytes;
    ++statistics.updates;
    statistics.update_bytes += bytes;
  }
}

void TrackPublisher::State::add_tick(double time) {
  TrackTick tick{server.state_->options.epoch,
                 distributor().updates(),
                 time,
                 server.state_->generation,
                 {},
                 round,
                 {}};
  for (const auto& volume : distributor().table()) {
    if (!volume->removed()) tick.scrolls.push_back(volume->described.geometry.scroll);
  }
  for (const auto& [stream, track] : tracks) {
    if (track.changed > round)
      add_to(tick.changed, stream, tick.update - track.changed, track.number);
  }
  add_message(TrackMessage::Type::tick, tick);
}

void TrackPublisher::State::add_list() {
  const Server::State& from = *server.state_;
  TrackList list{from.options.epoch, distributor().updates(), round, from.options.scene,
                 from.generation,    from.described_now(),    {}};
  for (const auto& [stream, track] : tracks) {
    if (track.snapshot != 0) add_to(list.snapshots, stream, list.update - track.snapshot, 0);
  }
  add_message(TrackMessage::Type::list, list);
  generation = from.generation;
}

Status TrackPublisher::update(double now, double time) {
  State& s = *state_;
  s.messages.clear();
  const std::uint64_t before = s.distributor().updates();
  const Status ready = guarded([&]() -> Status {
    if (s.generation != s.server.state_->generation) s.forget_removed();
    if (s.all == 0) {
      const auto all = s.distributor().connect(Delivery::shared);
      if (!all) return all.status();
      s.all = *all;
    }
    if (s.round_is_due(now)) s.begin_round(now);
    return Status::ok;
  });
  const Status updated = s.server.update(now, time);
  if (s.distributor().updates() == before) return updated == Status::ok ? ready : updated;
  const Status made = guarded([&]() -> Status {
    if (s.generation != s.server.state_->generation && s.generation != 0) s.add_list();
    for (const auto& [stream, packets] : by_stream(s.distributor().packets(s.all))) {
      s.add_object(s.all, stream, packets);
      if (s.first) s.awaited.emplace(stream, false);
    }
    for (const auto& [stream, packets] : by_stream(s.distributor().packets(s.newcomer))) {
      const auto awaited = s.awaited.find(stream);
      if (awaited == s.awaited.end() || awaited->second) continue;
      s.add_object(s.newcomer, stream, packets);
      awaited->second = true;
    }
    s.add_tick(time);
    s.end_round();
    return Status::ok;
  });
  if (made != Status::ok) s.begin_again();
  if (updated != Status::ok) return updated;
  return made == Status::ok ? ready : made;
}

std::span<const TrackMessage> TrackPublisher::messages() const noexcept { return state_->messages; }

std::optional<TrackName> TrackPublisher::name(StreamId stream) const noexcept {
  const auto table = state_->distributor().table();
  if (stream.volume >= table.size() || table[stream.volume]->removed()) return std::nullopt;
  const ServedVolume& volume = *table[stream.volume];
  for (const auto& bundle : volume.bundles) {
    for (const auto& texture : bundle->textures) {
      if (texture->id != stream.texture || stream.region >= bundle->cut.regions()) continue;
      return TrackName{volume.described.name, volume.described.textures[stream.texture].name,
                       bundle->cut.place_of(stream.region)};
    }
  }
  return std::nullopt;
}

void TrackPublisher::repeat_snapshots() noexcept {
  for (auto& [stream, track] : state_->tracks) track.snapshot = 0;
}

const TrackStatistics& TrackPublisher::statistics() const noexcept { return state_->statistics; }

}  // namespace gicodec
