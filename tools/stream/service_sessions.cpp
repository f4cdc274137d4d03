// What happens to the sessions of a service, for its log.
#include "clock.h"
#include "service.h"

#include <algorithm>

namespace gicodec::streaming {
namespace {

/// The flags that raise the limit of this reason. `lossy`: a texture loses bits by its backend.
const char* limits_of(Reason reason, bool lossy) {
  switch (reason) {
    case Reason::full:
      return " (--max-clients)";
    case Reason::unicast_full:
      return lossy ? " (lossy textures are for clients with --delivery shared)"
                   : " (--max-unicast, --max-unicast-per-address)";
    default:
      return "";
  }
}

}  // namespace

void Service::take_events() {
  for (const ServerEvent& event : server_.take_events()) take(event);
}

void Service::take(const ServerEvent& event) {
  if (event.type == ServerEvent::Type::expired) {
    sessions_.erase(event.client);
    return log("client {} forgotten", event.client);
  }
  const auto it = connections_.find(event.connection);
  if (it == connections_.end()) return;
  Connection& connection = it->second;
  switch (event.type) {
    case ServerEvent::Type::joined:
    case ServerEvent::Type::resumed: {
      if (event.type == ServerEvent::Type::joined) sessions_[event.client] = {now(), 0, 0};
      const auto statistics = server_.statistics(event.connection);
      const bool unicast = !statistics || statistics->delivery == Delivery::unicast;
      connection.user = access_->user(event.connection);
      statistics_.named(event.connection, connection.user);
      log("{} {} as client {} ({}{}{})", connection.address,
          event.type == ServerEvent::Type::joined ? "joined" : "came back", event.client,
          unicast ? "unicast" : "shared", connection.user.empty() ? "" : ", user ",
          connection.user);
      if (viewer_ && event.type == ServerEvent::Type::joined) show_nothing(event.connection);
      break;
    }
    case ServerEvent::Type::subscribed:
      connection.chooses = true;
      break;
    case ServerEvent::Type::dropped:
      ++dropped_[event.reason];
      if (event.reason == Reason::left) {
        log("{} left {}", connection.address, account(event.connection, true));
      } else {
        const bool lossy = std::ranges::any_of(
            volumes_, [](const FeedVolume& volume) { return !volume.quantisers.empty(); });
        log("{} {}: {}{}, {}", connection.address,
            event.reason == Reason::shutdown ? "let go" : "dropped", to_string(event.reason),
            limits_of(event.reason, lossy),
            account(event.connection, event.reason != Reason::replaced));
      }
      connection.closing = true;
      send(event.connection);
      net_.close(connection.link);
      break;
    default:
      break;
  }
}

/// The duration and traffic of a connection's session, for the log. Call it when the connection
/// ends; `ends`: the session does too.
std::string Service::account(ConnectionId id, bool ends) {
  const auto statistics = server_.statistics(id);
  const auto it = statistics ? sessions_.find(statistics->client) : sessions_.end();
  if (it == sessions_.end()) return "without a session";
  Session& session = it->second;
  session.bytes += statistics->bytes;
  session.updates += statistics->updates;
  std::string text = fmt::format("as client {} after {:.1f} s, {:.2f} MB in {}", statistics->client,
                                 now() - session.began, static_cast<double>(session.bytes) * 1e-6,
                                 count(session.updates, "update"));
  if (ends) sessions_.erase(it);
  return text;
}

}  // namespace gicodec::streaming
