// Buffers from the program's allocator, see set_memory(), or from that of the running call.
#pragma once

#include <gicodec/memory.h>

#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>
#include <vector>

namespace gicodec {

/// Tells that there is no memory. A build without exceptions ends, as its standard library does.
[[noreturn]] inline void fail_allocation() {
#ifdef __cpp_exceptions
  throw std::bad_alloc();
#else
  std::abort();
#endif
}

/// Returns null if the allocation fails.
[[nodiscard]] void* take_memory(std::size_t bytes, std::size_t alignment) noexcept;
void give_back(void* memory, std::size_t alignment) noexcept;

/// The allocator of the calls that run on this thread; null: the program's.
[[nodiscard]] const MemoryHook* memory_of_call() noexcept;

/// Sets it until the end of the scope. A buffer must be given back under the hook that it was taken
/// under.
class MemoryScope {
 public:
  explicit MemoryScope(const MemoryHook* hook) noexcept;
  ~MemoryScope();
  MemoryScope(const MemoryScope&) = delete;
  MemoryScope& operator=(const MemoryScope&) = delete;

 private:
  const MemoryHook* before_;
};

template <typename T>
struct Allocator {
  using value_type = T;

  Allocator() noexcept = default;
  template <typename U>
  Allocator(const Allocator<U>&) noexcept {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] T* allocate(std::size_t count) {
    const bool fits = count <= std::numeric_limits<std::size_t>::max() / sizeof(T);
    void* const memory = fits ? take_memory(count * sizeof(T), alignof(T)) : nullptr;
    if (memory == nullptr) fail_allocation();
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) noexcept { give_back(memory, alignof(T)); }

  friend bool operator==(const Allocator&, const Allocator&) = default;
};

template <typename T>
using Vector = std::vector<T, Allocator<T>>;

}  // namespace gicodec
