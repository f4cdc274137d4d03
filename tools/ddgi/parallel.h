// A pool of threads that runs a function over a range of indices.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace gicodec::ddgi {

/// Thrown by a job that was cancelled: what it was to write is incomplete.
struct Cancelled {};

/// Runs jobs one after the other; used by one thread at a time. Which thread runs which index is
/// not fixed, so a job must write results by index only.
class ThreadPool {
 public:
  /// 0: as many threads as the machine runs at once. The caller's thread is one of them. Where
  /// `cancelled`, asked before each index by all threads, says so, a job ends without the rest.
  explicit ThreadPool(unsigned threads = 0, std::function<bool()> cancelled = {});
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  [[nodiscard]] unsigned threads() const noexcept;
  /// Calls body(index) for every index below `count` and returns when all are done, or throws
  /// Cancelled. The body must not throw.
  void run(std::size_t count, const std::function<void(std::size_t)>& body);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec::ddgi
