// What a TrackReceiver takes from the publisher and the client, and asks the transport for.
#include <gicodec/track_receiver.h>

#include "base/guard.h"
#include "session/client/track_receiver_state.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gicodec {
TrackReceiver::TrackReceiver(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
TrackReceiver::TrackReceiver(TrackReceiver&&) noexcept = default;
TrackReceiver& TrackReceiver::operator=(TrackReceiver&&) noexcept = default;
TrackReceiver::~TrackReceiver() = default;

Result<TrackReceiver> TrackReceiver::create(const TrackReceiverOptions& options) {
  return guarded([&]() -> Result<TrackReceiver> {
    if (!std::isfinite(options.reach) || options.reach < 0) return Status::invalid_argument;
    auto state = std::make_unique<State>();
    state->options = options;
    state->interest.reach = options.reach;
    state->interest.subscribed_only = options.subscribed_only;
    return TrackReceiver(std::move(state));
  });
}

// From the publisher.

Status TrackReceiver::receive(std::span<const std::byte> message) {
  return guarded([&]() -> Status {
    State& s = *state_;
    WaitingObject waiting{Message(message.begin(), message.end()), {}};
    auto read = read_message(waiting.bytes, {.max_blocks = 0});
    if (read.status() == Status::out_of_memory) return read.status();
    if (!read) {
      ++s.statistics.damaged;
      return Status::ok;
    }
    if (auto* const object = std::get_if<TrackObject>(&*read)) {
      waiting.object = std::move(*object);
      return s.take(std::move(waiting));
    }
    const Status taken = std::visit([&](auto& one) { return s.take(std::move(one)); }, *read);
    if (taken == Status::corrupt) ++s.statistics.damaged;
    return taken;
  });
}

/// 0 for a message of the table, below 0 for an earlier one, above 0 for one of a later table,
/// whose list is then requested.
int TrackReceiver::State::compare_run(std::uint64_t epoch, std::uint32_t generation) noexcept {
  if (!table) return 1;
  const TrackList& list = table->list();
  const auto held = std::pair(list.epoch, list.generation);
  const auto said = std::pair(epoch, generation);
  if (said > held) wants_list = true;
  return said == held ? 0 : said < held ? -1 : 1;
}

Status TrackReceiver::State::take(TrackList list) {
  const int run = compare_run(list.epoch, list.generation);
  if (run < 0 || (run == 0 && list.update <= table->list().update)) {
    ++(run < 0 ? statistics.earlier : statistics.repeated);
    if (run == 0) wants_list = false;
    return Status::ok;
  }
  if (run == 0) {
    const Status taken = table->take(std::move(list));
    if (taken != Status::ok) return taken;
    if (tick) table->scroll(tick->scrolls);
  } else {
    auto made = TrackTable::create(std::move(list), options);
    if (!made) return made.status();
    TrackInterest next = interest;
    if (table && table->list().epoch == made->list().epoch) next.blocks.clear();
    const bool chosen = made->choose(next);
    // From here on nothing can fail.
    interest = std::move(next);
    restarts = restarts || welcomed;
    welcomed = false;
    table = *std::move(made);
    tick.reset();
    ticks = ticks_before = 0;
    waiting_bytes = 0;
    if (chosen) chose();
  }
  wants_list = false;
  lists_missed = 0;
  has_news = true;
  return Status::ok;
}

Status TrackReceiver::State::take(WaitingObject waiting) {
  const TrackObject& object = waiting.object;
  const int run = compare_run(object.epoch, object.generation);
  if (run < 0) ++statistics.earlier;
  if (run != 0) return Status::ok;
  const auto [unit, track] = table->find(object.stream);
  if (unit == nullptr || !unit->wanted) return Status::ok;
  const std::uint64_t update = object.update;
  const bool is_snapshot = object.previous == 0;
  const bool known =
      update <= track->at ||
      (is_snapshot ? track->newest_snapshot && track->newest_snapshot->object.update >= update
                   : track->updates.count(update) != 0);
  if (known) {
    ++statistics.repeated;
    return Status::ok;
  }
  const std::size_t bytes = memory_of(waiting);
  if (bytes > options.max_waiting_bytes - std::min(waiting_bytes, options.max_waiting_bytes)) {
    forget_all_waiting();
    return Status::ok;
  }
  if (is_snapshot) {
    if (track->newest_snapshot) waiting_bytes -= memory_of(*track->newest_snapshot);
    track->newest_snapshot = std::move(waiting);
  } else {
    track->updates.emplace(update, std::move(waiting));
  }
  waiting_bytes += bytes;
  ++statistics.objects;
  has_news = true;
  return Status::ok;
}

Status TrackReceiver::State::take(TrackTick said) {
  const int run = compare_run(said.epoch, said.generation);
  // The first request may have come too early, or to servers without a leader.
  if (!table && ++lists_missed % kFirstPatience == 0) wants_list = true;
  if (run != 0 || (tick && said.update <= tick->update)) {
    if (run <= 0) ++(run < 0 ? statistics.earlier : statistics.repeated);
    return Status::ok;
  }
  if (said.scrolls.size() != table->list().volumes.size()) return Status::corrupt;
  // The one before tells of changes that this one does not.
  if (new_tick && tick && said.round > tick->round && rounds++ < kMaxRounds) confirm(*tick);
  // A list is published after the tick that ends its round, and may be lost.
  lists_missed = said.round > table->list().round ? lists_missed + 1 : 0;
  if (lists_missed >= kFirstPatience) wants_list = true;
  table->scroll(said.scrolls);
  tick = std::move(said);
  ++ticks;
  ++statistics.ticks;
  requests_left = kMaxRequests;
  new_tick = has_news = true;
  return Status::ok;
}

/// Asks for the snapshots of all that then lacks something.
void TrackReceiver::State::forget_all_waiting() noexcept {
  for (TrackUnit& unit : table->units()) {
    for (Track& track : unit.tracks) track.forget_waiting();
  }
  waiting_bytes = 0;
}

void TrackReceiver::State::count_waiting() noexcept {
  waiting_bytes = 0;
  for (const TrackUnit& unit : table->units()) {
    for (const Track& track : unit.tracks) {
      if (track.newest_snapshot) waiting_bytes += memory_of(*track.newest_snapshot);
      for (const auto& [update, waiting] : track.updates) waiting_bytes += memory_of(waiting);
    }
  }
}

// From the client.

Status TrackReceiver::take(std::span<const std::byte> message) {
  return guarded([&]() -> Status {
    const auto read = read_message(message);
    if (read.status() == Status::out_of_memory) return read.status();
    if (!read) return Status::invalid_argument;
    return std::visit([&](const auto& one) { return state_->answer(one); }, *read);
  });
}

Status TrackReceiver::State::answer(const Hello& hello) {
  if (hello.delivery != Delivery::shared) return Status::invalid_argument;
  sync = hello.sync;
  number = 0;
  welcomed = restarts = begun = false;
  ticks_before = ticks;
  if (!table) return Status::ok;
  for (TrackUnit& unit : table->units()) {
    for (Track& track : unit.tracks) track.forget_held();
  }
  has_news = true;
  return Status::ok;
}

Status TrackReceiver::State::answer(const Resync& resync) {
  if (!sync || resync.sync <= *sync) return Status::ok;
  std::map<StreamId, HeldState> held;
  for (const HeldState& state : resync.held) held.emplace(state.stream, state);
  // From here on nothing can fail.
  sync = resync.sync;
  number = 0;
  if (!table) return Status::ok;
  for (TrackUnit& unit : table->units()) {
    bool lacks = false;
    for (Track& track : unit.tracks) {
      const auto found = held.find(track.stream);
      const bool has = found != held.end() && found->second.sequence == track.sent.sequence &&
                       found->second.checksum == track.sent.checksum;
      if (has || track.at == 0) continue;
      track.forget_held();
      lacks = true;
    }
    if (!lacks) continue;
    for (Track& track : unit.tracks) track.asks = unit.wanted;
  }
  has_news = new_tick = true;  // The client waits for an update of the sync point.
  return Status::ok;
}

Status TrackReceiver::State::answer(const Subscribe& subscribe) {
  if (!table || subscribe.generation != table->list().generation) return Status::ok;
  const auto volume = table->volume(subscribe.volume);
  if (!volume || subscribe.group >= table->groups(*volume)) return Status::invalid_argument;
  const auto& blocks = subscribe.blocks;
  if (!blocks.empty() && blocks.size() != table->blocks(*volume, subscribe.group))
    return Status::invalid_argument;
  TrackInterest next = interest;
  next.blocks[{subscribe.volume, subscribe.group}] = blocks;
  choose(std::move(next));
  return Status::ok;
}

Status TrackReceiver::State::answer(const Viewpoint& viewpoint) {
  if (interest.reach <= 0) {
    interest.viewpoint = viewpoint;
    return Status::ok;
  }
  TrackInterest next = interest;
  next.viewpoint = viewpoint;
  choose(std::move(next));
  return Status::ok;
}

/// What the client wishes to see comes with its first answer.
Status TrackReceiver::State::answer(const Acknowledge& acknowledge) {
  answered = answered || acknowledge.sync == sync;
  return Status::ok;
}

Status TrackReceiver::State::answer(const Goodbye& /*unused*/) {
  sync.reset();
  return Status::ok;
}

void TrackReceiver::State::choose(TrackInterest next) {
  const bool changed = table && table->choose(next);
  interest = std::move(next);
  if (changed) chose();
}

void TrackReceiver::State::chose() noexcept {
  ++changes;
  count_waiting();
  has_news = new_tick = true;
}

// To the transport.

bool TrackReceiver::wants_hello() const noexcept {
  const State& s = *state_;
  return s.restarts && s.tick && (s.all || s.ticks >= kFirstTicks);
}

std::span<const StreamId> TrackReceiver::wanted() const noexcept {
  const State& s = *state_;
  return s.table && s.answered ? s.table->wanted() : std::span<const StreamId>();
}

std::uint64_t TrackReceiver::wanted_changes() const noexcept { return state_->changes; }

/// Of a track that has lost some objects after its snapshot these are enough, at first.
void TrackReceiver::State::request(const TrackUnit& unit, const Track& track,
                                   std::vector<TrackRequests::Object>& out) const {
  const LastObject last = tick ? last_object(*tick, track.stream) : LastObject{};
  if (tick && has_all(*tick, track, track.at)) return;
  const bool knows_group = track.at != 0 && track.at >= track.snapshot;
  const std::uint32_t held = track.at > track.snapshot ? track.number : 0;
  std::uint32_t next = 0;
  if (knows_group && held < last.number && unit.behind <= kFirstPatience) next = held + 1;
  for (; next <= last.number; ++next) out.push_back({track.stream, next});
}

Result<TrackRequests> TrackReceiver::take_requests() {
  return guarded([&]() -> Result<TrackRequests> {
    State& s = *state_;
    TrackRequests requests;
    // Without a tick it is not known what there is.
    const auto wanted_now = s.tick ? wanted() : std::span<const StreamId>();
    std::size_t asked = 0;
    for (; asked < wanted_now.size() && requests.objects.size() < s.requests_left; ++asked) {
      const auto [unit, track] = s.table->find(wanted_now[asked]);
      if (track->asks) s.request(*unit, *track, requests.objects);
    }
    // From here on nothing can fail.
    for (const StreamId stream : wanted_now.first(asked))
      s.table->find(stream).second->asks = false;
    s.requests_left -= std::min(s.requests_left, requests.objects.size());
    requests.list = std::exchange(s.wants_list, false);
    s.statistics.requests += requests.objects.size();
    return requests;
  });
}

bool TrackReceiver::complete() const noexcept {
  const State& s = *state_;
  return s.welcomed && s.all && s.tick && !s.has_news;
}

std::optional<TrackName> TrackReceiver::name(StreamId stream) const noexcept {
  return state_->table ? state_->table->name(stream) : std::nullopt;
}

const TrackReceiverStatistics& TrackReceiver::statistics() const noexcept {
  return state_->statistics;
}

}  // namespace gicodec
