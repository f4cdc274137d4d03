#include "nats_receiver.h"

#include "clock.h"
#include "dump/dump.h"
#include "dump/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

namespace gicodec::streaming {
namespace {

using tools::NatsMessage;

constexpr double kHistorySilence = 2;  ///< seconds after which a request for updates is given up
/// Messages taken at once, before the client gets what they make.
constexpr int kMaxAtOnce = 4096;

TrackReceiver make_receiver(float reach) {
  TrackReceiverOptions options;
  options.reach = reach;
  return tools::take(TrackReceiver::create(options), "--reach");
}

}  // namespace

NatsReceiver::NatsReceiver(const NatsFlags& flags, float reach, double timeout)
    : subjects_(flags.prefix),
      tracks_(make_receiver(reach)),
      connection_(open_nats(flags, "gi-client", timeout)),
      timeout_(timeout),
      lost_(now()) {
  for (const std::string& subject :
       {connection_->inbox() + ".*", subjects_.list(), subjects_.tick()})
    static_cast<void>(connection_->subscribe(subject));
}

void NatsReceiver::push(NetEvent::Type type, Message message) {
  NetEvent event;
  event.type = type;
  event.link.nats = this;
  event.message = std::move(message);
  events_.push_back(std::move(event));
}

/// A short loss is made up for by what the servers kept; after a long one the link is closed.
void NatsReceiver::watch_connection() {
  const tools::NatsState state = connection_->state();
  if (state.connected) {
    lost_ = 0;
    if (!std::exchange(opened_, true)) push(NetEvent::Type::opened);
    return;
  }
  if (lost_ == 0) lost_ = now();
  if (closed_ || (!state.final && now() - lost_ < timeout_)) return;
  close();
  events_.back().why = nats_failure(state);
  events_.back().final = state.final && !opened_;
}

bool NatsReceiver::next(NetEvent& event, unsigned milliseconds) {
  if (events_.empty()) {
    NatsMessage message;
    int taken = 0;
    for (bool more = connection_->next(message, milliseconds); more && taken < kMaxAtOnce;
         ++taken) {
      handle(message);
      more = connection_->next(message, 0);
      if (!more) break;
    }
    watch_connection();
    if (opened_ && !closed_) {
      auto messages = tracks_.take_messages();
      if (messages) {
        for (Message& made : *messages) push(NetEvent::Type::received, std::move(made));
      }
      if (tracks_.wants_hello()) push(NetEvent::Type::renewed);
      follow_wanted();
      fetch();
    }
  }
  if (events_.empty()) return false;
  event = std::move(events_.front());
  events_.pop_front();
  return true;
}

void NatsReceiver::send(std::span<const std::byte> message) {
  static_cast<void>(tracks_.take(message));
  const auto read = read_message(message);
  if (read.ok() && std::holds_alternative<Goodbye>(*read)) close();
}

void NatsReceiver::close() {
  if (!std::exchange(closed_, true)) push(NetEvent::Type::closed);
}

void NatsReceiver::take(std::span<const std::byte> message) {
  const Status status = tracks_.receive(message);
  if (status == Status::unknown_kind || status == Status::limit_exceeded)
    tools::fail(tools::Exit::bad_input, "what is published cannot be used: {}", to_string(status));
}

void NatsReceiver::handle(const NatsMessage& message) {
  const bool of_history =
      history_.subscription != 0 && message.subscription == history_.subscription;
  if (of_history) {
    history_.heard = now();
    if (message.status.empty()) take(message.data);
    if (pending_behind(message) == 0) {
      connection_->unsubscribe(std::exchange(history_, {}).subscription);
    }
    return;
  }
  // What answers a request for a message has its place in the stream.
  const bool is_answer = message.subject.starts_with(connection_->inbox());
  if (is_answer && message.sequence == 0) return;
  take(message.data);
}

/// Subscribes to the updates of wanted tracks, and to no others.
void NatsReceiver::follow_wanted() {
  if (wanted_changes_ == tracks_.wanted_changes() &&
      tracks_.wanted().size() == subscriptions_.size())
    return;
  wanted_changes_ = tracks_.wanted_changes();
  const std::set<StreamId> wanted(tracks_.wanted().begin(), tracks_.wanted().end());
  std::erase_if(subscriptions_, [&](const auto& one) {
    const bool gone = wanted.count(one.first) == 0;
    if (gone) connection_->unsubscribe(one.second);
    return gone;
  });
  for (const StreamId stream : tracks_.wanted()) {
    if (subscriptions_.count(stream) != 0) continue;
    const auto name = tracks_.name(stream);
    if (!name) continue;
    const std::uint64_t made = connection_->subscribe(subjects_.update(*name));
    if (made != 0) subscriptions_[stream] = made;
  }
}

void NatsReceiver::fetch() {
  auto requests = tracks_.take_requests();
  if (!requests) return;
  const auto get = [this](const std::string& subject) {
    static_cast<void>(connection_->publish(
        get_last(subjects_, subject, fmt::format("{}.{}", connection_->inbox(), ++requests_))));
  };
  if (requests->list) {
    get(subjects_.list());
    get(subjects_.tick());
  }
  for (const StreamId stream : requests->snapshots) {
    if (const auto name = tracks_.name(stream)) get(subjects_.snapshot(*name));
    behind_.insert(stream);
  }
  if (requests->position != 0) position_ = requests->position;
  fetch_history();
}

/// Asks for the updates behind the snapshots, by one request for all tracks that lack some.
void NatsReceiver::fetch_history() {
  if (history_.subscription != 0) {
    if (now() - history_.heard < kHistorySilence) return;
    connection_->unsubscribe(std::exchange(history_, {}).subscription);
  }
  if (behind_.empty()) return;
  std::vector<TrackName> names;
  for (const StreamId stream : std::exchange(behind_, {})) {
    if (const auto name = tracks_.name(stream)) names.push_back(*name);
  }
  if (names.empty()) return;
  const std::string deliver = fmt::format("{}.h.{}", connection_->inbox(), ++requests_);
  history_ = {connection_->subscribe(deliver), now(), now()};
  static_cast<void>(
      connection_->publish(get_updates(subjects_, subjects_.updates(names), position_, deliver,
                                       fmt::format("{}.{}", connection_->inbox(), ++requests_))));
}

}  // namespace gicodec::streaming
