// How a NatsPublisher becomes the publisher: servers, streams, an epoch.
#include "clock.h"
#include "common/program.h"
#include "dump/error.h"
#include "dump/text.h"
#include "log.h"
#include "nats_publisher.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;
using tools::NatsMessage;

constexpr double kAskSeconds = 5;  ///< for one request

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
      turn.epoch = std::max({turn.epoch, claimed_epoch(*last) + 1, heard_epoch_ + 1});
      if (claimed_epoch(*last) == UINT64_MAX)
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
    NatsMessage request = make_claim(subjects_, turn.epoch);
    request.reply = reply();
    request.headers = {{"Nats-Expected-Last-Subject-Sequence", fmt::format("{}", sequence)}};
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

}  // namespace gicodec::streaming
