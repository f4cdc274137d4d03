#include "faults.h"

#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <new>

namespace gicodec::test {
namespace {

std::atomic<std::size_t> g_left{0};  ///< until the fault, itself included; 0: none is due
std::atomic<bool> g_lasting{false}, g_failed{false};

bool fails() noexcept {
  std::size_t left = g_left.load();
  while (left != 0 && !g_left.compare_exchange_weak(left, left - 1)) continue;
  if (left == 1) g_failed = true;
  return left == 1 || (left == 0 && g_failed && g_lasting);
}

void* allocate(std::size_t size, std::size_t alignment) noexcept {
  if (fails()) return nullptr;
  if (alignment <= alignof(std::max_align_t)) return std::malloc(size == 0 ? 1 : size);
  return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void* allocate_or_throw(std::size_t size, std::size_t alignment) {
  if (void* memory = allocate(size, alignment); memory != nullptr) return memory;
  throw std::bad_alloc();
}

}  // namespace

void Fault::arm(std::size_t nth, bool lasting) noexcept {
  g_failed = false;
  g_lasting = lasting;
  g_left = nth;
}

bool Fault::disarm() noexcept {
  g_left = 0;
  g_lasting = false;
  return g_failed.exchange(false);
}

}  // namespace gicodec::test

using gicodec::test::allocate;
using gicodec::test::allocate_or_throw;

void* operator new(std::size_t n) { return allocate_or_throw(n, 1); }
void* operator new[](std::size_t n) { return allocate_or_throw(n, 1); }
void* operator new(std::size_t n, const std::nothrow_t&) noexcept { return allocate(n, 1); }
void* operator new[](std::size_t n, const std::nothrow_t&) noexcept { return allocate(n, 1); }
void* operator new(std::size_t n, std::align_val_t a) {
  return allocate_or_throw(n, static_cast<std::size_t>(a));
}
void* operator new[](std::size_t n, std::align_val_t a) {
  return allocate_or_throw(n, static_cast<std::size_t>(a));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void* operator new(std::size_t n, std::align_val_t a, const std::nothrow_t&) noexcept {
  return allocate(n, static_cast<std::size_t>(a));
}
void* operator new[](std::size_t n, std::align_val_t a, const std::nothrow_t&) noexcept {
  return allocate(n, static_cast<std::size_t>(a));
}
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

using Create = int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
/// The sanitizer's, where it is linked into the program; it has to know all threads.
extern "C" [[gnu::weak]] Create __interceptor_pthread_create;

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes,
                              void* (*start)(void*), void* argument) noexcept {
  static const auto next = __interceptor_pthread_create != nullptr
                               ? &__interceptor_pthread_create
                               : reinterpret_cast<Create*>(dlsym(RTLD_NEXT, "pthread_create"));
  return gicodec::test::fails() ? EAGAIN : next(thread, attributes, start, argument);
}
