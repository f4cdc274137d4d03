// The commands of a running server's operator, and its metrics.
#include "clock.h"
#include "dump/error.h"
#include "metrics.h"
#include "service.h"

namespace gicodec::streaming {
namespace {

constexpr double kShow = 1;  ///< seconds between two states of the metrics

}  // namespace

void Service::serve_control() {
  if (!control_) return;
  control_->serve([this](const std::string& command) { return answer(command); });
}

std::string Service::answer(const std::string& command) {
  if (command == "list") return list();
  if (command == "reload") return reload();
  if (command.starts_with("drop ")) return drop(command.substr(5));
  return fmt::format("error: unknown command \"{}\"; there are: list, drop CLIENT, reload\n",
                     tools::printable(command));
}

std::string Service::list() {
  std::string text =
      fmt::format("{:>6}  {:21}  {:8}  {:>9}  {:>10}  {:>8}  {:>9}  {:6}  {}\n", "client",
                  "address", "delivery", "seconds", "MB", "updates", "in flight", "preset", "user");
  for (const auto& [id, connection] : connections_) {
    const auto s = server_.statistics(id);
    const auto it = s && !connection.closing ? sessions_.find(s->client) : sessions_.end();
    if (it == sessions_.end()) continue;
    text += fmt::format("{:6}  {:21}  {:8}  {:9.1f}  {:10.2f}  {:8}  {:9}  {:6}  {}\n", s->client,
                        connection.address, s->delivery == Delivery::unicast ? "unicast" : "shared",
                        now() - it->second.began,
                        static_cast<double>(it->second.bytes + s->bytes) * 1e-6,
                        it->second.updates + s->updates, s->in_flight,
                        s->preset.empty() ? std::string_view("-") : s->preset,
                        connection.user.empty() ? "-" : connection.user);
  }
  return text;
}

std::string Service::drop(const std::string& client) {
  for (const ConnectionId id : server_.connections().value_or({})) {
    if (fmt::format("{}", server_.client(id).value_or(0)) != client) continue;
    server_.drop(id, Reason::dismissed);
    take_events();
    return fmt::format("client {} is dropped\n", client);
  }
  return fmt::format("error: there is no client \"{}\" with a connection; see list\n",
                     tools::printable(client));
}

/// Reads the files of users and certificate again. Drops clients that may no longer connect.
std::string Service::reload() {
  try {
    Users users = access_->read();  // Changes nothing unless all can be read.
    net_.reload();
    access_->use(std::move(users));
  } catch (const tools::Error& error) {
    return fmt::format("error: {}\n", error.what());
  }
  std::size_t ended = 0;
  for (const ConnectionId id : access_->outdated()) {
    const auto it = connections_.find(id);
    if (it == connections_.end() || it->second.closing) continue;
    server_.drop(id, Reason::dismissed);
    ++ended;
  }
  take_events();
  const std::string text = fmt::format("reloaded: {}, {} ended", count(access_->users(), "user"),
                                       count(ended, "connection"));
  log("{}", text);
  return text + "\n";
}

void Service::show() {
  if (!options_.web || now() - shown_ < kShow) return;
  shown_ = now();
  const TurnedAway turned_away = net_.turned_away();
  if (turned_away.origins > 0) {
    log("{} of pages of other origins refused, the last one {}; --allow-origin {} lets its pages "
        "in",
        count(turned_away.origins, "connection"), turned_away.last_origin, turned_away.last_origin);
  }
  if (turned_away.count > 0) {
    dropped_[Reason::full] += turned_away.count;
    log("{} turned away, the last one {} (--max-per-address, --max-clients)",
        count(turned_away.count, "connection"), turned_away.last);
  }
  net_.show(metrics_text({server_.connections().value_or({}).size(), connections_.size(),
                          server_.updates(), server_.memory(), access_->unheard(), dropped_,
                          statistics_.totals(server_)}));
}

}  // namespace gicodec::streaming
