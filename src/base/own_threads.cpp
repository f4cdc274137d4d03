#include <gicodec/threads.h>

#ifndef GICODEC_NO_THREADS
#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <new>
#include <thread>
#endif

namespace gicodec {
namespace {

#ifdef GICODEC_NO_THREADS

void run_on_own_threads(void*, unsigned count, void (*work)(void*, unsigned) noexcept,
                        void* context) {
  for (unsigned i = 0; i < count; ++i) work(context, i);
}

#else

/// The work of one call; lives on the caller's stack.
struct Batch {
  void (*work)(void*, unsigned) noexcept;
  void* context;
  unsigned count, begun = 0, running = 0;
  Batch* next = nullptr;
};

/// Threads that take work from the oldest batch with some left. The caller takes part in its own
/// batch, so that it is done even if no other thread runs.
class OwnThreads {
 public:
  void run(Batch& batch) noexcept {
    std::unique_lock lock(mutex_);
    start(batch.count - 1);
    Batch** last = &first_;
    while (*last != nullptr) last = &(*last)->next;
    *last = &batch;
    for (unsigned other = 1; other < batch.count; ++other) there_is_work_.notify_one();
    while (batch.begun < batch.count) take_part(batch, lock);
    Batch** at = &first_;
    while (*at != &batch) at = &(*at)->next;
    *at = batch.next;
    while (batch.running > 0) one_is_done_.wait(lock);
  }

 private:
  void take_part(Batch& batch, std::unique_lock<std::mutex>& lock) noexcept {
    const unsigned i = batch.begun++;
    ++batch.running;
    lock.unlock();
    batch.work(batch.context, i);
    lock.lock();
    --batch.running;
    if (batch.begun == batch.count && batch.running == 0) one_is_done_.notify_all();
  }

  Batch* find() noexcept {
    Batch* batch = first_;
    while (batch != nullptr && batch->begun == batch->count) batch = batch->next;
    return batch;
  }

  void serve() noexcept {
    std::unique_lock lock(mutex_);
    for (;;) {
      ++idle_;
      while (find() == nullptr) there_is_work_.wait(lock);
      --idle_;
      take_part(*find(), lock);
    }
  }

  /// Starts more threads if fewer than `wanted` are idle.
  void start(unsigned wanted) noexcept {
    const unsigned processors = std::max(std::thread::hardware_concurrency(), 1U);
    const unsigned most = std::max(std::min(wanted, kMaxThreads - 1), processors - 1);
    for (unsigned idle = idle_; idle < wanted && started_ < most; ++idle, ++started_) {
      try {
        std::thread([this] { serve(); }).detach();
      } catch (...) {
        return;  // The running threads do all work.
      }
    }
  }

  std::mutex mutex_;
  std::condition_variable there_is_work_, one_is_done_;
  Batch* first_ = nullptr;
  unsigned started_ = 0, idle_ = 0;
};

void run_on_own_threads(void*, unsigned count, void (*work)(void*, unsigned) noexcept,
                        void* context) {
  // Never destroyed: its threads sleep in it until the process has ended.
  alignas(OwnThreads) static std::byte memory[sizeof(OwnThreads)];
  static OwnThreads& threads = *new (memory) OwnThreads;
  if (count == 0) return;
  Batch batch{work, context, count};
  threads.run(batch);
}

#endif

}  // namespace

Executor own_threads() noexcept { return {run_on_own_threads, nullptr}; }

}  // namespace gicodec
