// Runs a function over a range of indices, on the library's threads.
#pragma once

#include <gicodec/threads.h>

#include <cstddef>
#include <functional>

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

  [[nodiscard]] unsigned threads() const noexcept { return threads_; }
  /// Calls body(index) for every index below `count` and returns when all are done, or throws
  /// Cancelled. The body must not throw.
  void run(std::size_t count, const std::function<void(std::size_t)>& body);
  /// For long work between jobs: throws Cancelled if it is.
  void check() const;

 private:
  unsigned threads_;
  std::function<bool()> cancelled_;
};

}  // namespace gicodec::ddgi
