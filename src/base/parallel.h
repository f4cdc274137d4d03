// The same work for many items, on a given number of threads; all on the caller's in a library that
// is built without threads.
#pragma once

#include <cstddef>

#ifndef GICODEC_NO_THREADS
#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>
#endif

namespace gicodec {

/// That options may ask for.
inline constexpr unsigned kMaxThreads = 256;

#ifdef GICODEC_NO_THREADS

[[nodiscard]] inline unsigned thread_count(unsigned, std::size_t) noexcept { return 1; }

/// Calls body(0, item) for every item.
template <typename Body>
void for_each_item(unsigned, std::size_t items, Body&& body) {
  for (std::size_t item = 0; item < items; ++item) body(0U, item);
}

#else

/// The threads that for_each_item() uses, the caller's included: 1..threads.
[[nodiscard]] inline unsigned thread_count(unsigned threads, std::size_t items) noexcept {
  return static_cast<unsigned>(std::clamp<std::size_t>(items, 1, std::max(threads, 1U)));
}

/// Threads that end before they are forgotten.
class JoinedThreads {
 public:
  JoinedThreads() = default;
  JoinedThreads(const JoinedThreads&) = delete;
  JoinedThreads& operator=(const JoinedThreads&) = delete;
  ~JoinedThreads() {
    for (std::thread& thread : threads_) thread.join();
  }
  /// Starts work(1) to work(count - 1), or as many of them as the machine has threads for.
  template <typename Work>
  void start(unsigned count, const Work& work) noexcept {
    try {
      threads_.reserve(count);
      for (unsigned thread = 1; thread < count; ++thread) threads_.emplace_back(work, thread);
    } catch (...) {
      return;  // Those that run take the items of the others.
    }
  }

 private:
  std::vector<std::thread> threads_;
};

/// Calls body(thread, item) for every item, thread below thread_count(); returns when all are done.
/// The first exception is passed on. Works on fewer threads where no more can be started, and
/// throws only what `body` does.
template <typename Body>
void for_each_item(unsigned threads, std::size_t items, Body&& body) {
  const unsigned count = thread_count(threads, items);
  if (count == 1) {
    for (std::size_t item = 0; item < items; ++item) body(0U, item);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::atomic_flag failed = ATOMIC_FLAG_INIT;
  std::exception_ptr error;
  const auto work = [&](unsigned thread) noexcept {
    try {
      for (std::size_t item = next++; item < items; item = next++) body(thread, item);
    } catch (...) {
      if (!failed.test_and_set()) error = std::current_exception();
    }
  };
  {
    JoinedThreads others;
    others.start(count, work);
    work(0);
  }
  if (error) std::rethrow_exception(error);
}

#endif

/// Calls body(thread, first, count) for ranges of all items, on no more threads than have `minimum`
/// items each: starting one takes tens of microseconds. Throws only what `body` does.
template <typename Body>
void for_each_range(unsigned threads, std::size_t items, std::size_t minimum, Body&& body) {
  const unsigned count = thread_count(threads, items / minimum);
  // Smaller than a share, since threads do not start at the same time.
  const std::size_t ranges = count == 1 ? 1 : std::size_t{4} * count;
  for_each_item(count, ranges, [&](unsigned thread, std::size_t range) {
    const std::size_t first = items * range / ranges;
    body(thread, first, items * (range + 1) / ranges - first);
  });
}

}  // namespace gicodec
