// Runs the same work for many items on a given number of threads. A library built without threads
// runs it on the caller's.
#pragma once

#include <gicodec/threads.h>

#include "base/memory.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>

namespace gicodec {

[[nodiscard]] constexpr bool is_valid(const Threads& threads) noexcept {
  return threads.count >= 1 && threads.count <= kMaxThreads;
}

#ifdef GICODEC_NO_THREADS

[[nodiscard]] inline unsigned thread_count(const Threads&, std::size_t) noexcept { return 1; }

/// Calls body(0, item) for every item.
template <typename Body>
void for_each_item(const Threads&, std::size_t items, Body&& body) {
  for (std::size_t item = 0; item < items; ++item) body(0U, item);
}

#else

/// The threads that for_each_item() uses, the caller's included: 1..threads.count.
[[nodiscard]] inline unsigned thread_count(const Threads& threads, std::size_t items) noexcept {
  return static_cast<unsigned>(std::clamp<std::size_t>(items, 1, std::max(threads.count, 1U)));
}

/// Calls body(thread, item) for every item, thread below thread_count(); returns when all are done.
/// Rethrows the first exception of `body`. Allocates nothing.
template <typename Body>
void for_each_item(const Threads& threads, std::size_t items, Body&& body) {
  const unsigned count = thread_count(threads, items);
  if (count == 1) {
    for (std::size_t item = 0; item < items; ++item) body(0U, item);
    return;
  }
  struct Items {
    Body& body;
    std::size_t count;
    const MemoryHook* memory = memory_of_call();
    std::atomic<std::size_t> next{0};
    std::atomic<bool> failed{false};
    std::exception_ptr error{};

    static void take(void* self, unsigned thread) noexcept {
      Items& all = *static_cast<Items*>(self);
      const MemoryScope scope(all.memory);
      try {
        for (std::size_t item = all.next++; item < all.count; item = all.next++) {
          all.body(thread, item);
        }
      } catch (...) {
        if (!all.failed.exchange(true)) all.error = std::current_exception();
      }
    }
  };
  Items all{body, items};
  const Executor& given = threads.executor;
  const Executor executor = given.run != nullptr ? given : own_threads();
  executor.run(executor.self, count, Items::take, &all);
  Items::take(&all, 0);  // In case the executor broke its contract and left items.
  if (all.error) std::rethrow_exception(all.error);
}

#endif

/// Calls body(thread, first, count) for ranges that cover all items. Each thread gets at least
/// `minimum` items, as waking a thread takes tens of microseconds.
template <typename Body>
void for_each_range(const Threads& threads, std::size_t items, std::size_t minimum, Body&& body) {
  const unsigned count = thread_count(threads, items / minimum);
  // Several ranges per thread balance threads that start late.
  const std::size_t ranges = count == 1 ? 1 : std::size_t{4} * count;
  for_each_item({count, threads.executor}, ranges, [&](unsigned thread, std::size_t range) {
    const std::size_t first = items * range / ranges;
    body(thread, first, items * (range + 1) / ranges - first);
  });
}

}  // namespace gicodec
