#include "dump/memory_reserve.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace gicodec::tools {
namespace {

constexpr std::size_t kReserve = std::size_t{1} << 20;

std::atomic<void*> reserve = nullptr;
std::atomic<bool> ran_out = false;

void release() {
  ran_out = true;
  void* const kept = reserve.exchange(nullptr);
  if (kept == nullptr) throw std::bad_alloc();
  std::free(kept);
}

}  // namespace

void keep_memory_reserve() noexcept {
  reserve = std::malloc(kReserve);
  std::set_new_handler(release);
}

bool memory_ran_out() noexcept { return ran_out; }

}  // namespace gicodec::tools
