#include "parallel.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>

namespace gicodec::ddgi {

ThreadPool::ThreadPool(unsigned threads, std::function<bool()> cancelled)
    : threads_(threads != 0 ? threads : std::max(1U, std::thread::hardware_concurrency())),
      cancelled_(std::move(cancelled)) {}

void ThreadPool::run(std::size_t count, const std::function<void(std::size_t)>& body) {
  struct Job {
    const ThreadPool& pool;
    const std::function<void(std::size_t)>& body;
    std::size_t count;
    std::atomic<std::size_t> next{0};
    std::atomic<bool> gave_up{false};

    static void take(void* self, unsigned) noexcept {
      Job& job = *static_cast<Job*>(self);
      for (std::size_t i; (i = job.next.fetch_add(1, std::memory_order_relaxed)) < job.count;) {
        if (job.pool.cancelled_ && job.pool.cancelled_()) {
          job.gave_up = true;
          return;
        }
        job.body(i);
      }
    }
  };
  Job job{*this, body, count};
  const Executor executor = own_threads();
  executor.run(executor.self, threads_, Job::take, &job);
  if (job.gave_up) throw Cancelled();
}

void ThreadPool::check() const {
  if (cancelled_ && cancelled_()) throw Cancelled();
}

}  // namespace gicodec::ddgi
