#include "parallel.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace gicodec::ddgi {

struct ThreadPool::State {
  std::mutex mutex;
  std::condition_variable start, done;
  const std::function<void(std::size_t)>* body = nullptr;
  std::size_t count = 0;
  std::atomic<std::size_t> next{0};
  std::size_t generation = 0, busy = 0;
  bool stop = false;
  std::function<bool()> cancelled;
  std::atomic<bool> gave_up{false};
  std::vector<std::thread> workers;

  void drain(const std::function<void(std::size_t)>& function, std::size_t end) {
    for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < end;) {
      if (cancelled && cancelled()) {
        gave_up = true;
        return;
      }
      function(i);
    }
  }

  void work() {
    std::size_t seen = 0;
    std::unique_lock lock(mutex);
    for (;;) {
      start.wait(lock, [&] { return stop || generation != seen; });
      if (stop) return;
      seen = generation;
      const auto* function = body;
      const std::size_t end = count;
      lock.unlock();
      drain(*function, end);
      lock.lock();
      if (--busy == 0) done.notify_one();
    }
  }
};

ThreadPool::ThreadPool(unsigned threads, std::function<bool()> cancelled)
    : state_(std::make_unique<State>()) {
  state_->cancelled = std::move(cancelled);
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  for (unsigned i = 1; i < threads; ++i)
    state_->workers.emplace_back([s = state_.get()] { s->work(); });
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->stop = true;
  }
  state_->start.notify_all();
  for (auto& worker : state_->workers) worker.join();
}

unsigned ThreadPool::threads() const noexcept {
  return static_cast<unsigned>(state_->workers.size()) + 1;
}

void ThreadPool::run(std::size_t count, const std::function<void(std::size_t)>& body) {
  State& s = *state_;
  {
    const std::lock_guard lock(s.mutex);
    s.body = &body, s.count = count;
    s.next.store(0, std::memory_order_relaxed);
    s.gave_up = false;
    s.busy = s.workers.size();
    ++s.generation;
  }
  s.start.notify_all();
  s.drain(body, count);
  std::unique_lock lock(s.mutex);
  s.done.wait(lock, [&] { return s.busy == 0; });
  if (s.gave_up) throw Cancelled();
}

}  // namespace gicodec::ddgi
