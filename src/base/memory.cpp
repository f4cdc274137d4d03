#include "base/memory.h"

#include <gicodec/memory.h>

#include <atomic>

namespace gicodec {
namespace {

MemoryHook current_hook;  // not written while buffers exist
std::atomic<std::size_t> buffers{0};

/// True for the plain operator new, which programs commonly replace.
constexpr bool is_usual(std::size_t alignment) {
  return alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__;
}

void* allocate(std::size_t bytes, std::size_t alignment) noexcept {
  if (current_hook.allocate != nullptr) {
    return current_hook.allocate(current_hook.self, bytes, alignment);
  }
  if (is_usual(alignment)) return ::operator new(bytes, std::nothrow);
  return ::operator new(bytes, std::align_val_t(alignment), std::nothrow);
}

}  // namespace

void* take_memory(std::size_t bytes, std::size_t alignment) noexcept {
  ++buffers;
  void* const memory = allocate(bytes, alignment);
  if (memory == nullptr) --buffers;
  return memory;
}

void give_back(void* memory, std::size_t alignment) noexcept {
  if (current_hook.release != nullptr) {
    current_hook.release(current_hook.self, memory, alignment);
  } else if (is_usual(alignment)) {
    ::operator delete(memory);
  } else {
    ::operator delete(memory, std::align_val_t(alignment));
  }
  --buffers;
}

Status set_memory(const MemoryHook& hook) noexcept {
  const bool whole = (hook.allocate == nullptr) == (hook.release == nullptr);
  if (!whole) return Status::invalid_argument;
  if (buffers != 0) return Status::out_of_order;
  current_hook = hook;
  return Status::ok;
}

}  // namespace gicodec
