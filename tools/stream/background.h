// Work on a thread of its own, one request at a time, for a thread that must not wait.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace gicodec::streaming {

/// One thread at a time, apart from the work itself.
template <typename Request, typename Result>
class Background {
 public:
  explicit Background(std::function<Result(const Request&)> work)
      : work_(std::move(work)), thread_([this] { run(); }) {}
  /// Waits for the work under way.
  ~Background() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
  }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  /// True if nothing is under way and no result waits.
  [[nodiscard]] bool idle() const {
    const std::lock_guard lock(mutex_);
    return !request_ && !busy_ && !result_ && !error_;
  }
  /// Precondition: idle().
  void submit(Request request) {
    {
      const std::lock_guard lock(mutex_);
      request_ = std::move(request);
    }
    changed_.notify_all();
  }
  /// The finished result, if there is one. Rethrows what the work threw.
  [[nodiscard]] std::optional<Result> take() {
    const std::lock_guard lock(mutex_);
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    return std::exchange(result_, std::nullopt);
  }
  /// take(), waiting for it. Precondition: not idle().
  [[nodiscard]] Result wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return result_ || error_; });
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    return *std::exchange(result_, std::nullopt);
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return stop_ || request_; });
      if (stop_) return;
      const Request request = *std::exchange(request_, std::nullopt);
      busy_ = true;
      lock.unlock();
      std::optional<Result> result;
      std::exception_ptr error;
      try {
        result.emplace(work_(request));
      } catch (...) {
        error = std::current_exception();
      }
      lock.lock();
      busy_ = false;
      result_ = std::move(result);
      error_ = error;
      changed_.notify_all();
    }
  }

  std::function<Result(const Request&)> work_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Request> request_;
  std::optional<Result> result_;
  std::exception_ptr error_;
  bool busy_ = false, stop_ = false;
  std::jthread thread_;  // Last: ends before the others do.
};

}  // namespace gicodec::streaming
