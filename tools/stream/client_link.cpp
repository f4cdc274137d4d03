#include "client_link.h"

#include "clock.h"
#include "dump/error.h"
#include "log.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>

namespace gicodec::streaming {
namespace {

/// Seconds for one attempt to connect: a round trip, or four and a name to look up.
constexpr double kAttempt = 2, kWebAttempt = 8;
constexpr double kFirstBackoff = 0.1;  ///< seconds between attempts, doubled each time
constexpr double kLastBackoff = 4;
constexpr double kViewInterval = 0.02;  ///< seconds between two viewpoints, at least
constexpr unsigned kManyLosses = 2;     ///< after which it may be no accident
constexpr const char* kIfSlow =
    " (if the link is slow, --budget-bytes makes updates smaller, --timeout waits longer)";

}  // namespace

std::string no_answer(const Address& server, const std::string& why) {
  return fmt::format(
      "{}: no server answers{}{}{}; is it there, and has it room for more from here?",
      to_string(server), why.empty() ? "" : " (", why, why.empty() ? "" : ")");
}

std::string refused(const Address& server, const std::string& why) {
  return fmt::format("{}: {}", to_string(server), why);
}

std::string reason_and_cure(Reason reason) {
  const char* const cure = reason == Reason::token ? "; --token-file names the right one"
                           : reason == Reason::unicast_full
                               ? "; --delivery shared needs none of its own"
                               : "";
  return fmt::format("{}{}", to_string(reason), cure);
}

std::string unusable(Status status) {
  std::string_view cure;
  if (status == Status::unknown_kind)
    cure =
        "; it streams a volume of a kind that this gi-client does not know: a newer one may, or "
        "the "
        "application that the volume is for";
  if (status == Status::backend_missing)
    cure = "; it streams with a backend that this gi-client is built without, such as hevc";
  if (status == Status::limit_exceeded) cure = "; if it is memory, --max-memory allows more";
  return fmt::format("what the server sends cannot be used: {}{}", to_string(status), cure);
}

ClientLink::ClientLink(const LinkOptions& options, ClientThread& client)
    : options_(options), client_(client), thread_([this] { run(); }) {}

ClientLink::~ClientLink() { close(); }

void ClientLink::close() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void ClientLink::set_viewpoint(const Viewpoint& view) {
  const std::lock_guard lock(mutex_);
  view_ = view;
}

std::string ClientLink::message() const {
  const std::lock_guard lock(mutex_);
  return message_;
}

void ClientLink::fail(const std::string& message) {
  const std::lock_guard lock(mutex_);
  message_ = message;
  state_ = State::failed;
}

void ClientLink::wait(double seconds) const {
  const double end = now() + seconds;
  while (!stop_ && now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

void ClientLink::run() {
  try {
    double last_open = now(), backoff = kFirstBackoff;
    while (!stop_ && state_ != State::ended && state_ != State::failed) {
      state_ = State::connecting;
      // A new port for each attempt: late answers to earlier attempts would be taken for answers to
      // this one.
      Net net(options_.server.via, options_.net);
      if (const Link link = connect(net)) {
        late_ = false;
        serve(net, link);
        if (!late_) {
          backoff = kFirstBackoff;
          last_open = now();
          continue;
        }
      }
      if (stop_ || state_ == State::failed) return;
      if (now() - last_open > options_.patience)
        return fail(no_answer(options_.server, why_) + (losses_ > 0 ? kIfSlow : ""));
      wait(backoff);
      backoff = std::min(2 * backoff, kLastBackoff);
    }
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

Link ClientLink::connect(Net& net) {
  const Link link = net.connect(options_.server);
  const double end = now() + (options_.server.via == Via::enet ? kAttempt : kWebAttempt);
  NetEvent event;
  while (!stop_ && now() < end) {
    if (!net.next(event, 10) || event.link != link) continue;
    if (event.type == NetEvent::Type::opened) return link;
    if (event.type != NetEvent::Type::closed) continue;
    why_ = event.why;
    if (event.final) fail(refused(options_.server, event.why));
    return {};
  }
  net.abandon(link);
  return {};
}

bool ClientLink::over() {
  const Status status = client_.status();
  if (status == Status::ok) return false;
  if (status != Status::end) {
    fail(unusable(status));
    return true;
  }
  const Goodbye goodbye = client_.goodbye().value_or({});
  if (goodbye.reason == Reason::shutdown) {
    const std::lock_guard lock(mutex_);
    message_ = "the server has ended";
    state_ = State::ended;
  } else if (goodbye.reason == Reason::silent) {
    late_ = true;
    lost();
  } else {
    fail("turned away by the server: " + reason_and_cure(goodbye.reason));
  }
  return true;
}

void ClientLink::lost() {
  ++losses_;
  if (options_.quiet) return;
  log_line("gi-client: {}: connection lost; trying again{}", to_string(options_.server),
           losses_ < kManyLosses ? "" : kIfSlow);
}

bool ClientLink::greet(Net& net, Link link) {
  const auto hello = client_.hello();
  if (!hello) {
    fail(std::string(to_string(hello.status())));
    return false;
  }
  net.send(link, {*hello});
  return true;
}

void ClientLink::serve(Net& net, Link link) {
  if (!greet(net, link)) return;
  ++connections_;
  state_ = State::open;
  double viewed = now();
  NetEvent event;
  while (!stop_) {
    for (bool more = net.next(event, 2); more; more = net.next(event, 0)) {
      if (event.type == NetEvent::Type::closed) {
        // The Goodbye may still be in the client's queue.
        while (!client_.idle() && !stop_) wait(1e-3);
        if (!over()) lost();
        return;
      }
      if (event.type == NetEvent::Type::renewed && !greet(net, link)) return;
      if (event.type == NetEvent::Type::remark && !options_.quiet)
        log_line("gi-client: {}: {}", to_string(options_.server), event.why);
      if (event.type != NetEvent::Type::received) continue;
      const Status status = client_.push(std::move(event.message));
      if (status == Status::limit_exceeded) {
        fail("decoding does not keep up with what the server sends");
        return say_goodbye(net, link);
      }
    }
    if (now() - viewed > kViewInterval) {
      const std::lock_guard lock(mutex_);
      // Without memory the server keeps the last viewpoint.
      if (view_) static_cast<void>(client_.set_viewpoint(*std::exchange(view_, {})));
      viewed = now();
    }
    send_messages(net, link);
    round_trip_ = Net::round_trip_ms(link);
    if (over()) return leave(net, link);
  }
  send_messages(net, link);
  say_goodbye(net, link);
}

void ClientLink::say_goodbye(Net& net, Link link) {
  if (client_.disconnect() == Status::ok) send_messages(net, link);
  leave(net, link);
}

void ClientLink::send_messages(Net& net, Link link) {
  for (Message& message : client_.take_messages()) net.send(link, {std::move(message)});
}

/// After a Goodbye of either end, the server closes the link. If both ends closed it, ENet would
/// not answer one of them, and the server would keep the place until its time-out.
void ClientLink::leave(Net& net, Link link) {
  const double end = now() + kGoodbye;
  NetEvent event;
  while (now() < end) {
    if (net.next(event, 10) && event.type == NetEvent::Type::closed) return;
  }
  net.abandon(link);
}

}  // namespace gicodec::streaming
