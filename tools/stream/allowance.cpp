#include "allowance.h"

#include <algorithm>

namespace gicodec::streaming {
namespace {

constexpr std::size_t kMaxHosts = 4096;

}  // namespace

double Allowance::left(const Left& left, double now) const {
  return std::min(burst_, left.count + (now - left.at) * per_second_);
}

bool Allowance::has(const std::string& host, double now) const {
  const auto it = hosts_.find(host);
  return it == hosts_.end() || left(it->second, now) >= 1;
}

void Allowance::take(const std::string& host, double now) {
  if (hosts_.size() >= kMaxHosts && !hosts_.contains(host)) {
    std::erase_if(hosts_, [&](const auto& one) { return left(one.second, now) >= burst_; });
    if (hosts_.size() >= kMaxHosts) {
      hosts_.erase(
          std::ranges::min_element(hosts_, {}, [](const auto& one) { return one.second.at; }));
    }
  }
  Left& counted = hosts_.try_emplace(host, Left{burst_, now}).first->second;
  counted = {std::max(left(counted, now) - 1, 0.0), now};
}

}  // namespace gicodec::streaming
