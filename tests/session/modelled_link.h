// A path between a server and its clients in virtual time: all share one bottleneck, which serves
// those who wait in turn, and each has a link of its own behind it.
#pragma once

#include <gicodec/protocol.h>

#include <algorithm>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace gicodec::test {

/// What waits for one client, and its link.
struct Flow {
  double rate = 1e18;  ///< bytes per second of its own link
  double delay = 0;    ///< seconds in each direction
  struct Waiting {
    Message message;
    double left = 0;  ///< bytes that the bottleneck has not served
  };
  std::deque<Waiting> waiting;
  double own_done = 0;  ///< when its own link has sent what the bottleneck let through
  std::deque<std::pair<double, Message>> down, up;  ///< and when it arrives

  [[nodiscard]] std::size_t unsent() const {
    std::size_t bytes = 0;
    for (const Waiting& one : waiting) bytes += one.message.size();
    return bytes;
  }
};

/// Lets the bottleneck work for so many seconds until `now`; even shares for all who wait.
inline void serve(std::vector<Flow>& flows, double rate, double seconds, double now) {
  double left = rate * seconds;
  std::vector<Flow*> busy;
  for (Flow& flow : flows) {
    if (!flow.waiting.empty()) busy.push_back(&flow);
  }
  while (left > 1e-6 && !busy.empty()) {
    const double share = left / static_cast<double>(busy.size());
    for (Flow* flow : busy) {
      double mine = share;
      while (mine > 0 && !flow->waiting.empty()) {
        Flow::Waiting& first = flow->waiting.front();
        const double served = std::min(mine, first.left);
        mine -= served;
        left -= served;
        first.left -= served;
        if (first.left > 1e-9) break;
        const auto bytes = static_cast<double>(first.message.size());
        flow->own_done = std::max(flow->own_done, now) + bytes / flow->rate;
        flow->down.emplace_back(flow->own_done + flow->delay, std::move(first.message));
        flow->waiting.pop_front();
      }
    }
    std::erase_if(busy, [](const Flow* flow) { return flow->waiting.empty(); });
  }
}

inline void send(Flow& flow, Message message) {
  const auto size = static_cast<double>(message.size());
  flow.waiting.push_back({std::move(message), size});
}

inline std::optional<Message> arrived(std::deque<std::pair<double, Message>>& way, double now) {
  if (way.empty() || way.front().first > now) return std::nullopt;
  Message message = std::move(way.front().second);
  way.pop_front();
  return message;
}

}  // namespace gicodec::test
