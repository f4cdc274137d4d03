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
  return beside > kBurst + (now - link.since) * kPerSecond + kPerByte * payload +
                      kPerMessage * static_cast<double>(link.messages);
}

WebLink* HalfOpen::add(WebLink* link) {
  links_.push_back(link);
  if (links_.size() <= kMost) return nullptr;
  std::map<std::string_view, std::size_t> counts;
  for (const WebLink* one : links_) ++counts[one->peer.host];
  const auto most =
      std::ranges::max_element(counts, {}, [](const auto& one) { return one.second; });
  return take(std::string(most->first));
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
