#include "base/memory.h"

#include <atomic>

namespace gicodec {
namespace {

MemoryHook program_hook;  // not written while buffers exist
std::atomic<std::size_t> buffers{0};
thread_local const MemoryHook* hook_of_call = nullptr;

/// True for the plain operator new, which programs commonly replace.
constexpr bool is_usual(std::size_t alignment) {
  return alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__;
}

void* allocate(const MemoryHook& hook, std::size_t bytes, std::size_t alignment) noexcept {
  if (hook.allocate != nullptr) return hook.allocate(hook.self, bytes, alignment);
  if (is_usual(alignment)) return ::operator new(bytes, std::nothrow);
  return ::operator new(bytes, std::align_val_t(alignment), std::nothrow);
}

void release(const MemoryHook& hook, void* memory, std::size_t alignment) noexcept {
  if (hook.release != nullptr) {
    hook.release(hook.self, memory, alignment);
  } else if (is_usual(alignment)) {
    ::operator delete(memory);
  } else {
    ::operator delete(memory, std::align_val_t(alignment));
  }
}

}  // namespace

void* take_memory(std::size_t bytes, std::size_t alignment) noexcept {
  if (hook_of_call != nullptr) return allocate(*hook_of_call, bytes, alignment);
  ++buffers;
  void* const memory = allocate(program_hook, bytes, alignment);
  if (memory == nullptr) --buffers;
  return memory;
}

void give_back(void* memory, std::size_t alignment) noexcept {
  if (hook_of_call != nullptr) return release(*hook_of_call, memory, alignment);
  release(program_hook, memory, alignment);
  --buffers;
}

const MemoryHook* memory_of_call() noexcept { return hook_of_call; }
MemoryScope::MemoryScope(const MemoryHook* hook) noexcept : before_(hook_of_call) {
  hook_of_call = hook;
}
MemoryScope::~MemoryScope() { hook_of_call = before_; }

Status set_memory(const MemoryHook& hook) noexcept {
  const bool whole = (hook.allocate == nullptr) == (hook.release == nullptr);
  if (!whole) return Status::invalid_argument;
  if (buffers != 0) return Status::out_of_order;
  program_hook = hook;
  return Status::ok;
}

}  // namespace gicodec
