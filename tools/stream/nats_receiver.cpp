#include "nats_receiver.h"

#include "clock.h"
#include "dump/dump.h"
#include "dump/error.h"

#include <fmt/core.h>

#include <set>
#include <utility>

namespace gicodec::streaming {
namespace {

using tools::NatsMessage;

/// Messages taken at once, before the client gets what they make.
constexpr int kMaxAtOnce = 4096;
/// Seconds without a tick after which the user is told.
constexpr double kSilence = 5;

}  // namespace

NatsReceiver::NatsReceiver(const NatsFlags& flags, const TrackReceiverOptions& options,
                           double timeout)
    : subjects_(flags.prefix),
      tracks_(tools::take(TrackReceiver::create(options), "--reach")),
      connection_(open_nats(flags, "gi-client", timeout)),
      timeout_(timeout),
      lost_(now()),
      heard_(now()) {
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
    if (!closed_ && is_refused(state)) {
      close();
      events_.back().why = nats_failure(state);
      events_.back().final = true;
    }
    return;
  }
  if (lost_ == 0) lost_ = now();
  if (closed_ || (!state.final && now() - lost_ < timeout_)) return;
  close();
  events_.back().why = nats_failure(state);
  events_.back().final = state.final && !opened_;
}

/// Says why there is nothing new.
void NatsReceiver::watch_publisher() {
  const TrackReceiverStatistics& seen = tracks_.statistics();
  if (seen.ticks != ticks_ || lost_ != 0) {
    const bool again = std::exchange(silent_, false) && seen.ticks != ticks_;
    ticks_ = seen.ticks;
    earlier_ = seen.earlier;
    heard_ = now();
    if (!again) return;
    push(NetEvent::Type::remark);
    events_.back().why = "light is published again";
  } else if (!silent_ && now() - heard_ > kSilence) {
    silent_ = true;
    push(NetEvent::Type::remark);
    events_.back().why =
        seen.ticks == 0
            ? fmt::format(
                  "nothing is published under {}; gi-server --nats with this --nats-prefix "
                  "does, over servers with JetStream (nats-server -js)",
                  subjects_.prefix())
        : seen.earlier != earlier_
            ? "what is published now is of an earlier epoch than what came before, and ignored: "
              "its "
              "clock is behind; start it anew when the clock is right, or this viewer"
            : fmt::format("nothing was published for {} s; the last state stays", kSilence);
  }
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
    watch_publisher();
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

void NatsReceiver::handle(const NatsMessage& message) {
  // What answers a request for a message has its place in the stream; else there is none.
  const bool is_answer = message.subject.starts_with(connection_->inbox());
  if (is_answer && message.sequence == 0) return;
  const Status status = tracks_.receive(message.data);
  if (status == Status::unknown_kind || status == Status::limit_exceeded)
    tools::fail(tools::Exit::bad_input, "what is published cannot be used: {}", to_string(status));
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
    const std::uint64_t made = connection_->subscribe(subjects_.updates(*name));
    if (made != 0) subscriptions_[stream] = made;
  }
}

void NatsReceiver::fetch() {
  auto requests = tracks_.take_requests();
  if (!requests) return;
  const auto get = [this](const std::string& stream, const std::string& subject) {
    const std::string reply = fmt::format("{}.{}", connection_->inbox(), ++requests_);
    static_cast<void>(connection_->publish(get_last(stream, subject, reply)));
  };
  if (requests->list) {
    get(subjects_.kept_stream(), subjects_.list());
    get(subjects_.kept_stream(), subjects_.tick());
  }
  for (const auto& [stream, number] : requests->objects) {
    const auto name = tracks_.name(stream);
    if (!name) continue;
    get(number == 0 ? subjects_.kept_stream() : subjects_.update_stream(),
        subjects_.object(*name, number));
  }
}

}  // namespace gicodec::streaming
