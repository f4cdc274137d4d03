#include "publishing.h"

#include "common/program.h"
#include "dump/error.h"
#include "log.h"
#include "nats_flags.h"

#include <optional>

namespace gicodec::streaming {
namespace {

/// Keeps a feed where another publisher is: traces what that shows, or plays up to it.
class Follower {
 public:
  Follower(Feed& feed, double start) : feed_(feed), start_(start) {}
  void operator()(std::optional<double> time) const {
    if (!feed_.played) {
      static_cast<void>(feed_.next({time.value_or(start_), {}, true}));
      return;
    }
    // As far as a recording goes, once.
    constexpr int kMaxFrames = 100000;
    for (int i = 0; time && i < kMaxFrames && !tools::interrupted(); ++i) {
      if (feed_.next({}).time == *time) return;
    }
  }

 private:
  Feed& feed_;
  double start_;
};

}  // namespace

std::unique_ptr<NatsPublisher> begin_publishing(ServerFlags& o, Feed& feed) {
  check_nats_flags(o.nats.nats);
  if (o.nats.nats.urls.empty()) {
    if (o.standby) tools::fail(tools::Exit::usage, "--standby is for --nats");
    return nullptr;
  }
  NatsFlags& nats_flags = o.nats.nats;
  if (!nats_flags.password_file.empty())
    nats_flags.password = tools::read_token({"", nats_flags.password_file}).text;
  o.nats.streams.keep_bytes = std::uint64_t{o.nats_max_mb} << 20;
  o.nats.streams.keep_seconds = kept_seconds(o.service.tracks);
  auto nats = std::make_unique<NatsPublisher>(o.nats);
  if (!o.standby) {
    o.server.epoch = nats->begin().epoch;
    if (!o.service.quiet && !tools::interrupted())
      log_line("gi-server: publishing over {} under {}; a publisher before this one ends",
               nats_flags.urls, nats_flags.prefix);
    return nats;
  }
  if (!o.service.quiet) log_line("gi-server: standing by");
  const auto turn = nats->stand_by(Follower(feed, o.service.start));
  if (!turn) return nats;
  o.server.epoch = turn->epoch;
  if (turn->time) o.service.start = *turn->time + 1 / o.service.rate;
  if (!o.service.quiet) log_line("gi-server: the publisher is gone; this one goes on");
  return nats;
}

}  // namespace gicodec::streaming
