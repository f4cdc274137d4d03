#include "nats_publisher.h"

#include "clock.h"
#include "common/program.h"
#include "dump/error.h"
#include "dump/text.h"
#include "log.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <utility>

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;
using tools::NatsMessage;

constexpr double kRepeat = 1;      ///< seconds without an answer after which a message is repeated
constexpr double kGiveUp = 20;     ///< seconds after which the next snapshots make up for it
constexpr double kAskSeconds = 5;  ///< for one request at the beginning
constexpr double kResume = 0.5;    ///< seconds after an answer that servers are not ready
constexpr const char* kFullCure =
    "max_memory_store in the servers' configuration gives it more room, --nats-max-mb asks for "
    "less";
constexpr std::size_t kMaxUnanswered = std::size_t{256} << 20;  ///< bytes

Message text_message(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::uint64_t number_of(std::string_view text) {
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

/// That of the request.
std::uint64_t number_of_answer(const NatsMessage& message) {
  return number_of(std::string_view(message.subject).substr(message.subject.rfind('.') + 1));
}

/// The epoch that a claim names.
std::uint64_t claimed(const NatsMessage& message) {
  return number_of({reinterpret_cast<const char*>(message.data.data()), message.data.size()});
}

std::string scroll_text(const std::vector<Scroll>& scrolls) {
  std::string text;
  for (const Scroll& scroll : scrolls)
    text += fmt::format("{}{},{},{}", text.empty() ? "" : " ", scroll[0], scroll[1], scroll[2]);
  return text;
}

}  // namespace

NatsPublisher::NatsPublisher(const NatsPublisherOptions& options)
    : options_(options),
      subjects_(options.nats.prefix),
      connection_(open_nats(options.nats, "gi-server", options.timeout)) {
  answers_ = connection_->subscribe(connection_->inbox() + ".*");
  claims_ = connection_->subscribe(subjects_.publisher());
  ticks_ = connection_->subscribe(subjects_.tick());
  wait_for_servers();
  make_streams();
}

void NatsPublisher::wait_for_servers() {
  const double began = now(), end = began + options_.patience;
  bool said = false;
  while (!tools::interrupted()) {
    const tools::NatsState state = connection_->state();
    if (!state.connected && !said && now() > began + options_.timeout) {
      log_line("gi-server: waiting for --nats {}: {}", options_.nats.urls, nats_failure(state));
      said = true;
    }
    if (state.connected) {
      connections_ = state.connections;
      return;
    }
    if (state.final || now() > end)
      fail(Exit::io, "--nats {}: {}", options_.nats.urls, nats_failure(state));
    NatsMessage ignored;
    static_cast<void>(connection_->next(ignored, 10));
  }
}

/// The answer to a request, or nothing in time. Other messages are dropped.
std::optional<NatsMessage> NatsPublisher::answer_to(const NatsMessage& request, double seconds) {
  NatsMessage sent = request;
  static_cast<void>(connection_->publish(std::move(sent)));
  const double end = now() + seconds;
  NatsMessage message;
  while (now() < end && !tools::interrupted()) {
    if (!connection_->next(message, 20)) continue;
    if (message.subscription == answers_ && message.subject == request.reply) return message;
  }
  return std::nullopt;
}

/// Servers do not answer what a user may not ask: they say so apart.
void NatsPublisher::check_rights(const char* what) {
  const tools::NatsState state = connection_->state();
  if (is_refused(state))
    fail(Exit::io, "--nats {}: {}: {}", options_.nats.urls, what, nats_failure(state));
}

/// The same, which must come.
NatsMessage NatsPublisher::ask(const NatsMessage& request, const char* what) {
  const double end = now() + options_.patience;
  while (!tools::interrupted()) {
    auto answer = answer_to(request, kAskSeconds);
    // A cluster that has no leader yet does not answer, or says that there is nobody to answer.
    const bool answered =
        answer && answer->status != "503" && stream_answer(*answer).error != kErrorNoLeader;
    if (answered) return *std::move(answer);
    check_rights(what);
    if (now() > end)
      fail(Exit::io, "--nats {}: {}: no server with JetStream answers; start nats-server with -js",
           options_.nats.urls, what);
    NatsMessage ignored;
    static_cast<void>(connection_->next(ignored, 100));
  }
  return {};
}

void NatsPublisher::make_streams() {
  const auto make = [this](auto request) {
    // One that exists must not be counted twice against the servers' limits.
    for (const bool exists : {true, false}) {
      const std::string reply = fmt::format("{}.{}", connection_->inbox(), ++requests_);
      const NatsMessage message = request(subjects_, options_.streams, exists, reply);
      const NatsMessage answered = ask(message, "making streams");
      if (tools::interrupted()) return;
      const StreamAnswer answer = stream_answer(answered);
      if (answer.error == 0) return;
      if (answer.error == kErrorNoStream && exists) continue;
      fail(Exit::io,
           "--nats {}: JetStream refuses to keep {}: {}; --nats-replicas and --nats-max-mb say how "
           "much it is asked for, max_memory_store in the servers' configuration how much it has",
           options_.nats.urls, message.subject.substr(message.subject.rfind('.') + 1),
           tools::printable(answer.text));
    }
  };
  make(make_kept_stream);
  make(make_update_stream);
}

/// Takes the next epoch. nullopt: another publisher did, or without `wait` it could not be stored.
std::optional<Turn> NatsPublisher::claim(bool wait) {
  const double end = now() + options_.patience;
  while (!tools::interrupted()) {
    const auto reply = [this] { return fmt::format("{}.{}", connection_->inbox(), ++requests_); };
    Turn turn{unix_seconds(), {}};
    std::uint64_t sequence = 0;
    const auto last =
        answer_to(get_last(subjects_.kept_stream(), subjects_.publisher(), reply()), kAskSeconds);
    if (!last || last->status == "503") {  // Servers that began anew have forgotten all.
      check_rights("asking who publishes");
      make_streams();
      if (!last && now() > end)
        fail(Exit::io, "--nats {}: asking who publishes: no answer", options_.nats.urls);
      continue;
    }
    if (last->status.empty()) {
      turn.epoch = std::max({turn.epoch, claimed(*last) + 1, heard_epoch_ + 1});
      if (claimed(*last) == UINT64_MAX)
        fail(Exit::io,
             "--nats {}: somebody has claimed the last epoch there is; delete the streams {} and "
             "{}, and start viewers anew",
             options_.nats.urls, subjects_.kept_stream(), subjects_.update_stream());
      sequence = last->sequence;
    }
    const NatsMessage tick = ask(get_last(subjects_.kept_stream(), subjects_.tick(), reply()),
                                 "asking for the last update");
    const auto read = read_message(tick.data);
    if (const auto* said = read.ok() ? std::get_if<TrackTick>(&*read) : nullptr)
      turn.time = said->time;
    NatsMessage request;
    request.subject = subjects_.publisher();
    request.reply = reply();
    request.headers = {{"Nats-Expected-Last-Subject-Sequence", fmt::format("{}", sequence)}};
    request.data = text_message(fmt::format("{}", turn.epoch));
    const auto answer = answer_to(request, kAskSeconds);
    const StreamAnswer stored = answer ? stream_answer(*answer) : StreamAnswer{{}, 0, -1, {}};
    if (stored.error == 0) {
      epoch_ = turn.epoch;
      return turn;
    }
    const std::string why =
        fmt::format("JetStream does not store who publishes: {}; {}",
                    stored.text.empty() ? "no answer" : tools::printable(stored.text), kFullCure);
    if (!wait) {
      if (faults_.insert(Fault::not_stored).second)
        log_line("gi-server: cannot take over: {}", why);
      return std::nullopt;
    }
    if (now() > end) fail(Exit::io, "--nats {}: {}", options_.nats.urls, why);
    NatsMessage ignored;
    static_cast<void>(connection_->next(ignored, 100));
  }
  return std::nullopt;
}

Turn NatsPublisher::begin() { return claim(true).value_or(Turn{}); }

std::optional<Turn> NatsPublisher::stand_by(
    const std::function<void(std::optional<double>)>& follow) {
  follow(std::nullopt);
  double heard = now();
  NatsMessage message;
  std::optional<double> time;  // that is not followed yet
  while (!tools::interrupted()) {
    if (connection_->next(message, time ? 0 : 20)) {
      if (message.subscription != claims_ && message.subscription != ticks_) continue;
      heard = now();
      const auto read = read_message(message.data);
      const auto* const tick = read.ok() ? std::get_if<TrackTick>(&*read) : nullptr;
      if (tick == nullptr) continue;
      time = tick->time;
      if (tick->epoch < UINT64_MAX) heard_epoch_ = std::max(heard_epoch_, tick->epoch);
      continue;
    }
    if (time) {
      follow(std::exchange(time, std::nullopt));
      continue;
    }
    // Without a connection it is this program that is alone.
    if (!connection_->state().connected) heard = now();
    if (now() - heard < options_.standby_after) continue;
    if (const auto turn = claim(false)) return turn;
    heard = now();
  }
  return std::nullopt;
}

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

void NatsPublisher::answered(const NatsMessage& message) {
  if (!unanswered_.contains(number_of_answer(message))) return;
  const StreamAnswer answer = stream_answer(message);
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
    answered(message);
  } else if (message.subscription == claims_) {
    replaced_ = replaced_ || claimed(message) > epoch_;
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

/// After a loss of the connection somebody else may publish, and servers that began anew have
/// forgotten all.
void NatsPublisher::ask_to_resume(std::uint64_t connections) {
  const bool waits = resume_request_ != 0 && resumed_connections_ == connections;
  if (now() - asked_ < (waits ? kAskSeconds : kResume)) return;
  asked_ = now();
  resumed_connections_ = connections;
  resume_request_ = ++requests_;
  const std::string reply = fmt::format("{}.{}", connection_->inbox(), resume_request_);
  for (NatsMessage request : {make_kept_stream(subjects_, options_.streams, false, ""),
                              make_update_stream(subjects_, options_.streams, false, ""),
                              get_last(subjects_.kept_stream(), subjects_.publisher(), reply)})
    static_cast<void>(connection_->publish(std::move(request)));
}

/// Goes on, if this is still the last publisher. `last`: who the last one is.
void NatsPublisher::resume(const NatsMessage& last, TrackPublisher& tracks) {
  resume_request_ = 0;
  if (last.status == "503") return;  // The next try finds the streams that this one has made.
  replaced_ = replaced_ || (last.status.empty() && claimed(last) > epoch_);
  if (replaced_) return;
  connections_ = resumed_connections_;
  if (last.status == "404") {
    NatsMessage claim;
    claim.subject = subjects_.publisher();
    claim.data = text_message(fmt::format("{}", epoch_));
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
