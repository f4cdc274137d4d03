#include "access.h"

#include "secrets.h"

#include <algorithm>

namespace gicodec::streaming {
namespace {

constexpr std::size_t kMaxHosts = 4096;
constexpr double kMinute = 60;

}  // namespace

double Guesses::left(const Left& left, double now) {
  return std::min(kPerMinute, left.guesses + (now - left.at) * kPerMinute / kMinute);
}

bool Guesses::may(const std::string& host, double now) {
  const auto it = hosts_.find(host);
  return it == hosts_.end() || left(it->second, now) >= 1;
}

void Guesses::wrong(const std::string& host, double now) {
  if (hosts_.size() >= kMaxHosts && !hosts_.contains(host)) {
    std::erase_if(hosts_, [&](const auto& one) { return left(one.second, now) >= kPerMinute; });
    if (hosts_.size() >= kMaxHosts) {
      hosts_.erase(
          std::ranges::min_element(hosts_, {}, [](const auto& one) { return one.second.at; }));
    }
  }
  Left& counted = hosts_.try_emplace(host, Left{kPerMinute, now}).first->second;
  counted = {left(counted, now) - 1, now};
}

Access::Access(std::string token, std::string users_file)
    : token_(std::move(token)), file_(std::move(users_file)) {
  reload();
}

void Access::reload() {
  if (!file_.empty()) users_ = read_users(file_);
}

std::optional<Reason> Access::judge(PeerId peer, std::string_view token, double now) {
  Peer& who = peers_[peer];
  if (!asks()) return std::nullopt;
  if (!guesses_.may(who.host, now)) {
    ++unheard_;
    return Reason::token;
  }
  if (!token_.empty() && same_secret(token, token_)) return std::nullopt;
  who.user = file_.empty() ? std::string() : user_of(users_, token);
  if (!who.user.empty()) {
    who.as = users_.find(who.user)->second;
    return std::nullopt;
  }
  guesses_.wrong(who.host, now);
  return Reason::token;
}

std::string Access::user(PeerId peer) const {
  const auto it = peers_.find(peer);
  return it == peers_.end() ? std::string() : it->second.user;
}

std::vector<PeerId> Access::outdated() const {
  std::vector<PeerId> peers;
  for (const auto& [id, peer] : peers_) {
    if (peer.user.empty()) continue;
    const auto it = users_.find(peer.user);
    if (it == users_.end() || !(it->second == peer.as)) peers.push_back(id);
  }
  return peers;
}

}  // namespace gicodec::streaming
