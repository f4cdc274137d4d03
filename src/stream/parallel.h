// The same work for many items, on a given number of threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace gicodec {

/// Calls body(thread, item) for every item, thread in 0..threads-1; returns when all are done.
/// `body` must not throw.
template <typename Body>
void for_each_item(unsigned threads, std::size_t items, Body&& body) {
  std::atomic<std::size_t> next{0};
  const auto work = [&](unsigned thread) {
    for (std::size_t item = next++; item < items; item = next++) body(thread, item);
  };
  const auto count = static_cast<unsigned>(std::min<std::size_t>(threads, items));
  std::vector<std::jthread> others;
  for (unsigned thread = 1; thread < count; ++thread) others.emplace_back(work, thread);
  work(0);
}

}  // namespace gicodec
