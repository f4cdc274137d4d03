// Messages that the servers have not said to keep: of each subject the last one.
#pragma once

#include "modules/nats.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

namespace gicodec::streaming {

class UnansweredMessages {
 public:
  /// `number`: above all before.
  void add(std::uint64_t number, const tools::NatsMessage& message, double now) {
    const auto [last, is_new] = numbers_.try_emplace(message.subject, number);
    if (!is_new) drop(messages_.find(std::exchange(last->second, number)));
    messages_.emplace(number, Unanswered{message, now, now});
    bytes_ += message.data.size();
  }

  void remove(std::uint64_t number) {
    const auto found = messages_.find(number);
    if (found == messages_.end()) return;
    numbers_.erase(found->second.message.subject);
    drop(found);
  }

  /// Drops the oldest, while they are older than that or too many. True if there were any.
  bool give_up(double before, std::size_t max_bytes) {
    const std::size_t count = messages_.size();
    while (!messages_.empty() && (messages_.begin()->second.first < before || bytes_ > max_bytes))
      remove(messages_.begin()->first);
    return messages_.size() < count;
  }

  /// Calls send(message) for those last sent before that time, the oldest first, while it is true.
  template <typename Send>
  void repeat(double before, double now, const Send& send) {
    for (auto& [number, one] : messages_) {
      if (one.last > before) continue;
      one.last = now;
      if (!send(one.message)) return;
    }
  }

  [[nodiscard]] bool contains(std::uint64_t number) const { return messages_.count(number) != 0; }
  [[nodiscard]] std::size_t size() const noexcept { return messages_.size(); }

 private:
  struct Unanswered {
    tools::NatsMessage message;
    double first = 0, last = 0;  ///< when it was published
  };
  using Messages = std::map<std::uint64_t, Unanswered>;

  void drop(Messages::iterator which) {
    bytes_ -= which->second.message.data.size();
    messages_.erase(which);
  }

  Messages messages_;                             ///< by number
  std::map<std::string, std::uint64_t> numbers_;  ///< by subject
  std::size_t bytes_ = 0;
};

}  // namespace gicodec::streaming
