#include "access.h"

#include "secrets.h"

namespace gicodec::streaming {
namespace {

/// Wrong tokens that are listened to from an address, at once and in each minute.
constexpr double kGuesses = 5, kMinute = 60;

}  // namespace

Access::Access(std::string token, std::string users_file)
    : token_(std::move(token)),
      file_(std::move(users_file)),
      guesses_(kGuesses, kGuesses / kMinute) {
  users_ = read();
}

Users Access::read() const { return file_.empty() ? Users() : read_users(file_); }

std::optional<Reason> Access::judge(ConnectionId connection, std::string_view token, double now) {
  Connection& peer = connections_[connection];
  if (!asks()) return std::nullopt;
  if (!guesses_.has(peer.host, now)) {
    ++unheard_;
    return Reason::token;
  }
  if (!token_.empty() && same_secret(token, token_)) return std::nullopt;
  peer.user = file_.empty() ? std::string() : user_of(users_, token);
  if (!peer.user.empty()) {
    peer.as = users_.find(peer.user)->second;
    return std::nullopt;
  }
  guesses_.take(peer.host, now);
  return Reason::token;
}

std::string Access::user(ConnectionId connection) const {
  const auto it = connections_.find(connection);
  return it == connections_.end() ? std::string() : it->second.user;
}

std::vector<ConnectionId> Access::outdated() const {
  std::vector<ConnectionId> connections;
  for (const auto& [id, connection] : connections_) {
    if (connection.user.empty()) continue;
    const auto it = users_.find(connection.user);
    if (it == users_.end() || !(it->second == connection.as)) connections.push_back(id);
  }
  return connections;
}

}  // namespace gicodec::streaming
