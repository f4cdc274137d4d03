// Preloaded into a program: its allocation of number GICODEC_FAILING fails. At the end it writes
// how many there were to the file GICODEC_ALLOCATIONS.
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

extern "C" void* __libc_malloc(std::size_t);
extern "C" void* __libc_calloc(std::size_t, std::size_t);
extern "C" void* __libc_realloc(void*, std::size_t);

namespace {

std::atomic<long> failing = -1, number = 0;

bool fails() {
  if (failing < 0) {
    const char* const said = std::getenv("GICODEC_FAILING");
    failing = said == nullptr ? 0 : std::atol(said);
  }
  if (++number != failing) return false;
  errno = ENOMEM;
  return true;
}

struct Count {
  ~Count() {
    const char* const path = std::getenv("GICODEC_ALLOCATIONS");
    const int file = path == nullptr ? -1 : open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    char digits[24];
    std::size_t at = sizeof digits;
    for (long rest = number; rest > 0; rest /= 10)
      digits[--at] = static_cast<char>('0' + rest % 10);
    if (file >= 0 && write(file, digits + at, sizeof digits - at) < 0) _exit(125);
  }
} count;

}  // namespace

extern "C" void* malloc(std::size_t size) { return fails() ? nullptr : __libc_malloc(size); }
extern "C" void* calloc(std::size_t count_of, std::size_t size) {
  return fails() ? nullptr : __libc_calloc(count_of, size);
}
extern "C" void* realloc(void* from, std::size_t size) {
  return fails() ? nullptr : __libc_realloc(from, size);
}
