// What has come over NATS and waits to be taken.
#pragma once

#include "modules/nats.h"

#include <nats/nats.h>

#include <charconv>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <new>
#include <string>
#include <utility>

namespace gicodec::tools {

/// Memory that a message takes.
[[nodiscard]] inline std::size_t memory_of(const NatsMessage& message) noexcept {
  constexpr std::size_t kMessage = 256;
  std::size_t bytes = kMessage + message.data.size() + message.subject.size();
  for (const auto& [key, value] : message.headers) bytes += key.size() + value.size();
  return bytes;
}

/// A header of a message, or nothing.
[[nodiscard]] inline std::string header(natsMsg* message, const char* key) {
  const char* value = nullptr;
  return natsMsgHeader_Get(message, key, &value) == NATS_OK && value != nullptr ? value : "";
}

/// The messages that wait for next(). Outlives the connection while libnats delivers.
class Inbound {
 public:
  explicit Inbound(std::size_t limit) : limit_(limit) {}

  void add(std::uint64_t subscription, natsMsg* received) noexcept;
  bool take(NatsMessage& message, unsigned milliseconds);
  [[nodiscard]] std::uint64_t dropped() {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable came_;
  std::deque<NatsMessage> messages_;
  std::size_t bytes_ = 0, limit_;
  std::uint64_t dropped_ = 0;
};

inline void Inbound::add(std::uint64_t subscription, natsMsg* received) noexcept {
  try {
    NatsMessage message;
    message.subscription = subscription;
    message.subject = natsMsg_GetSubject(received);
    if (const char* reply = natsMsg_GetReply(received)) message.reply = reply;
    message.status = header(received, "Status");
    const std::string sequence = header(received, "Nats-Sequence");
    std::from_chars(sequence.data(), sequence.data() + sequence.size(), message.sequence);
    const auto* const data = reinterpret_cast<const std::byte*>(natsMsg_GetData(received));
    message.data.assign(data, data + natsMsg_GetDataLength(received));
    const std::size_t bytes = memory_of(message);
    const std::lock_guard lock(mutex_);
    if (bytes_ + bytes > limit_) {
      ++dropped_;
      return;
    }
    messages_.push_back(std::move(message));
    bytes_ += bytes;
    came_.notify_one();
  } catch (const std::bad_alloc&) {
    const std::lock_guard lock(mutex_);
    ++dropped_;
  }
}

inline bool Inbound::take(NatsMessage& message, unsigned milliseconds) {
  std::unique_lock lock(mutex_);
  const bool came = came_.wait_for(lock, std::chrono::milliseconds(milliseconds),
                                   [this] { return !messages_.empty(); });
  if (!came) return false;
  message = std::move(messages_.front());
  messages_.pop_front();
  bytes_ -= memory_of(message);
  return true;
}

}  // namespace gicodec::tools
