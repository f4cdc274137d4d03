#include "nats_publisher.h"
#include "clock.h"
#include "dump/error.h"
#include "dump/text.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

namespace gicodec::streaming {
namespace {

using tools::NatsMessage;

constexpr double kRepeat = 1;    ///< seconds without an answer after which a message is repeated
constexpr double kGiveUp = 20;   ///< seconds after which the next snapshots make up for it
constexpr double kResume = 0.5;  ///< seconds after an answer that servers are not ready
constexpr double kResumePatience = 5;  ///< seconds for an answer to whether this one may go on
constexpr std::size_t kMaxUnanswered = std::size_t{256} << 20;  ///< bytes

/// That of the request.
std::uint64_t number_of_answer(const NatsMessage& message) {
  return number_in(std::string_view(message.subject).substr(message.subject.rfind('.') + 1));
}

std::string scroll_text(const std::vector<Scroll>& scrolls) {
  std::string text;
  for (const Scroll& scroll : scrolls)
    text += fmt::format("{}{},{},{}", text.empty() ? "" : " ", scroll[0], scroll[1], scroll[2]);
  return text;
}

}  // namespace

void NatsPublisher::remark(const std::string& text) {
  remarks_ += (remarks_.empty() ? "" : "; ") + text;
}

/// Once, until it is over.
void NatsPublisher::remark(Fault fault, const std::string& text) {
  if (faults_.insert(fault).second) remark(text);
}

std::string NatsPublisher::remarks() { return std::exchange(remarks_, {}); }

void NatsPublisher::publish(TrackPublisher& tracks) {
  const tools::NatsState state = connection_->state();
  // What would arrive late is in the next snapshots.
  if (!state.connected || state.connections != connections_) return;
  std::string time, scroll;
  std::uint64_t update = 0;
  for (const TrackMessage& message : tracks.messages()) {
    if (message.type != TrackMessage::Type::tick) continue;
    const auto read = read_message(message.bytes);
    if (const auto* tick = read.ok() ? std::get_if<TrackTick>(&*read) : nullptr) {
      time = fmt::format("{}", tick->time);
      scroll = scroll_text(tick->scrolls);
      update = tick->update;
    }
  }
  const decltype(NatsMessage::headers) headers{{"Gi-Epoch", fmt::format("{}", epoch_)},
                                               {"Gi-Update", fmt::format("{}", update)},
                                               {"Gi-Time", time},
                                               {"Gi-Scroll", scroll}};
  for (const TrackMessage& message : tracks.messages()) {
    NatsMessage sent;
    const auto name = tracks.name(message.stream);
    switch (message.type) {
      case TrackMessage::Type::list:
        sent.subject = subjects_.list();
        break;
      case TrackMessage::Type::tick:
        sent.subject = subjects_.tick();
        break;
      case TrackMessage::Type::object:
        if (name) sent.subject = subjects_.object(*name, message.number);
    }
    if (sent.subject.empty()) continue;
    sent.data = message.bytes;
    sent.headers = headers;
    // Headers count, too: "NATS/1.0", a line each, and that which is added below.
    std::size_t bytes = sent.data.size() + 64;
    for (const auto& [key, value] : sent.headers) bytes += key.size() + value.size() + 4;
    if (state.max_payload > 0 && bytes > state.max_payload) {
      remark(Fault::too_large,
             fmt::format("{}: {} bytes are more than the servers take, {}; smaller regions by "
                         "--region make smaller messages, max_payload in their configuration "
                         "allows larger ones",
                         tools::printable(sent.subject), bytes, state.max_payload));
      continue;
    }
    if (message.type != TrackMessage::Type::tick) {
      const std::uint64_t number = ++requests_;
      sent.headers.emplace_back("Nats-Msg-Id", fmt::format("{}-{}", epoch_, number));
      sent.reply = fmt::format("{}.{}", connection_->inbox(), number);
      unanswered_.add(number, sent, now());
    }
    if (!connection_->publish(std::move(sent)))
      remark(Fault::slow, "the servers take messages more slowly than they come");
  }
}

void NatsPublisher::answered(const NatsMessage& message, TrackPublisher& tracks) {
  if (!unanswered_.contains(number_of_answer(message))) return;
  const StreamAnswer answer = stream_answer(message);
  if (message.status == "503" && now() - asked_ > kResumePatience) {
    // There is no leader, or somebody has deleted the streams.
    asked_ = now();
    publish_streams();
    tracks.repeat_snapshots();
  }
  if (answer.error != 0) {
    // It is repeated.
    remark(
        Fault::not_stored,
        fmt::format("JetStream does not store messages: {}; viewers that come now wait; {}",
                    answer.text.empty() ? "no answer" : tools::printable(answer.text), kFullCure));
    return;
  }
  unanswered_.remove(number_of_answer(message));
  if (faults_.erase(Fault::not_stored) != 0) remark("JetStream stores messages again");
}

void NatsPublisher::handle(const NatsMessage& message, TrackPublisher& tracks) {
  if (message.subscription == answers_) {
    if (resume_request_ != 0 && number_of_answer(message) == resume_request_)
      return resume(message, tracks);
    answered(message, tracks);
  } else if (message.subscription == claims_) {
    replaced_ = replaced_ || claimed_epoch(message) > epoch_;
  }
}

/// Repeats what was not answered, and gives up what is too old.
void NatsPublisher::repeat(TrackPublisher& tracks) {
  const double at = now();
  const bool lost = unanswered_.give_up(at - kGiveUp, kMaxUnanswered);
  // Not more often: a server that stores nothing would cause snapshots with every update.
  if (lost && at - gave_up_ > kGiveUp) {
    gave_up_ = at;
    tracks.repeat_snapshots();
  }
  unanswered_.repeat(at - kRepeat, at, [this](const NatsMessage& message) {
    NatsMessage again = message;
    return connection_->publish(std::move(again));
  });
}

/// Asks for the streams, if they are not there.
void NatsPublisher::publish_streams() {
  for (NatsMessage request : {make_kept_stream(subjects_, options_.streams, false, ""),
                              make_update_stream(subjects_, options_.streams, false, "")})
    static_cast<void>(connection_->publish(std::move(request)));
}

/// After a loss of the connection somebody else may publish, and servers that began anew have
/// forgotten all.
void NatsPublisher::ask_to_resume(std::uint64_t connections) {
  const bool waits = resume_request_ != 0 && resumed_connections_ == connections;
  if (now() - asked_ < (waits ? kResumePatience : kResume)) return;
  asked_ = now();
  resumed_connections_ = connections;
  resume_request_ = ++requests_;
  const std::string reply = fmt::format("{}.{}", connection_->inbox(), resume_request_);
  publish_streams();
  static_cast<void>(
      connection_->publish(get_last(subjects_.kept_stream(), subjects_.publisher(), reply)));
}

/// Goes on, if this is still the last publisher. `last`: who the last one is.
void NatsPublisher::resume(const NatsMessage& last, TrackPublisher& tracks) {
  resume_request_ = 0;
  if (last.status == "503") return;  // The next try finds the streams that this one has made.
  replaced_ = replaced_ || (last.status.empty() && claimed_epoch(last) > epoch_);
  if (replaced_) return;
  connections_ = resumed_connections_;
  if (last.status == "404") {
    NatsMessage claim = make_claim(subjects_, epoch_);
    static_cast<void>(connection_->publish(std::move(claim)));
  }
  faults_.clear();
  remark("NATS is reached again");
  tracks.repeat_snapshots();
}

bool NatsPublisher::attend(TrackPublisher& tracks) {
  NatsMessage message;
  while (connection_->next(message, 0)) handle(message, tracks);
  const tools::NatsState state = connection_->state();
  if (!state.connected) {
    remark(Fault::not_reached, fmt::format("NATS is not reached: {}", nats_failure(state)));
  } else if (state.connections != connections_) {
    ask_to_resume(state.connections);
  } else {
    repeat(tracks);
  }
  return !replaced_;
}

}  // namespace gicodec::streaming
