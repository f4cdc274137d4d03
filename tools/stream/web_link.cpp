#include "web_link.h"

#include <algorithm>
#include <map>
#include <string_view>

namespace gicodec::streaming {
namespace {

constexpr double kBurst = 64 << 10;      ///< bytes: handshakes, and what comes at once
constexpr double kPerSecond = 32 << 10;  ///< bytes: pings and the like
constexpr double kPerMessage = 64;       ///< bytes around each
constexpr double kPerByte = 0.25;        ///< small fragments and records

}  // namespace

bool floods(const WebLink& link, double now) {
  const auto payload = static_cast<double>(link.payload);
  const double beside = static_cast<double>(link.tcp.read) - payload;
  return beside > kBurst + (now - link.created) * kPerSecond + kPerByte * payload +
                      kPerMessage * static_cast<double>(link.messages);
}

WebLink* HalfOpen::add(WebLink* link) {
  // Chooses among earlier connections: an address with most has one there, unless all have one.
  auto oldest = links_.end();
  if (links_.size() >= kMax) {
    std::map<std::string_view, std::size_t> counts{{link->peer.host, 1}};
    for (const WebLink* one : links_) ++counts[one->peer.host];
    const auto count = [](const auto& one) { return one.second; };
    const auto most = std::ranges::max_element(counts, {}, count)->second;
    oldest = std::ranges::find_if(
        links_, [&](const WebLink* one) { return counts[one->peer.host] == most; });
  }
  links_.push_back(link);
  if (oldest == links_.end()) return nullptr;
  WebLink* const out = *oldest;
  links_.erase(oldest);
  return out;
}

WebLink* HalfOpen::take(const std::string& host) {
  const auto oldest =
      std::ranges::find_if(links_, [&](const WebLink* one) { return one->peer.host == host; });
  if (oldest == links_.end()) return nullptr;
  WebLink* const out = *oldest;
  links_.erase(oldest);
  return out;
}

}  // namespace gicodec::streaming
