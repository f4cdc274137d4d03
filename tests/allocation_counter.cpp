// Sanitizers call hooks; elsewhere malloc and its relatives are replaced by counting ones over
// glibc's.
#include "allocation_counter.h"

#include "sanitizers.h"

#include <atomic>
#include <cerrno>
#include <cstdint>

namespace gicodec::test {
namespace {

// From far above zero, since something may be freed that was allocated before counting began.
constinit std::atomic<std::size_t> g_now{std::size_t{1} << 40}, g_peak{0}, g_total{0}, g_count{0};

void add(std::size_t size) {
  g_total.fetch_add(size, std::memory_order_relaxed);
  g_count.fetch_add(1, std::memory_order_relaxed);
  const std::size_t now = g_now.fetch_add(size, std::memory_order_relaxed) + size;
  std::size_t peak = g_peak.load(std::memory_order_relaxed);
  while (peak < now && !g_peak.compare_exchange_weak(peak, now, std::memory_order_relaxed)) {
  }
}
void remove(std::size_t size) { g_now.fetch_sub(size, std::memory_order_relaxed); }

}  // namespace

std::size_t heap_bytes() noexcept { return g_now; }
std::size_t heap_peak() noexcept { return g_peak; }
std::size_t heap_total() noexcept { return g_total; }
std::size_t heap_allocations() noexcept { return g_count; }
void start_peak() noexcept { g_peak = g_now.load(); }

}  // namespace gicodec::test

using gicodec::test::add;
using gicodec::test::remove;

#if defined(GICODEC_ASAN) || defined(GICODEC_TSAN)

// GCC has no header for these.
extern "C" {
int __sanitizer_install_malloc_and_free_hooks(void (*)(const volatile void*, std::size_t),
                                              void (*)(const volatile void*));
std::size_t __sanitizer_get_allocated_size(const volatile void*);
}

namespace {
[[maybe_unused]] const int g_hooks = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t size) { add(size); },
    [](const volatile void* pointer) {
      if (pointer != nullptr) remove(__sanitizer_get_allocated_size(pointer));
    });
}  // namespace

#else

#include <malloc.h>

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

static void* counted(void* pointer) {
  if (pointer != nullptr) add(malloc_usable_size(pointer));
  return pointer;
}

void* malloc(std::size_t size) noexcept { return counted(__libc_malloc(size)); }
void* calloc(std::size_t count, std::size_t size) noexcept {
  return counted(__libc_calloc(count, size));
}
void* realloc(void* pointer, std::size_t size) noexcept {
  const std::size_t before = pointer == nullptr ? 0 : malloc_usable_size(pointer);
  void* const moved = __libc_realloc(pointer, size);
  if (moved != nullptr || size == 0) remove(before);
  return counted(moved);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  return counted(__libc_memalign(alignment, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return memalign(alignment, size);
}
int posix_memalign(void** pointer, std::size_t alignment, std::size_t size) noexcept {
  *pointer = memalign(alignment, size);
  return *pointer == nullptr ? ENOMEM : 0;
}
void free(void* pointer) noexcept {
  if (pointer != nullptr) remove(malloc_usable_size(pointer));
  __libc_free(pointer);
}
}

#endif
