// What a module of the npm package has beside the library. Each object of the package has an
// instance of its own, and with it memory of its own: one that has no memory left ends alone.
#include <gicodec/c/client.h>
#include <gicodec/c/container.h>
#include <gicodec/c/encoder.h>
#include <gicodec/c/server.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "layout.inl"

namespace {

/// The bytes of a container as they arrive.
struct {
  std::uint8_t* bytes;
  std::size_t size, capacity, at;
} arrived;

gicodec_status read(void*, void* into, std::size_t bytes, std::size_t* got) {
  *got = std::min(bytes, arrived.size - arrived.at);
  std::memcpy(into, arrived.bytes + arrived.at, *got);
  arrived.at += *got;
  return GICODEC_OK;
}

gicodec_status seek(void*, std::uint64_t offset) {
  if (offset > arrived.size) return GICODEC_IO_FAILED;
  arrived.at = static_cast<std::size_t>(offset);
  return GICODEC_OK;
}

std::uint64_t size(void*) { return arrived.size; }

constexpr gicodec_source kSource{sizeof(gicodec_source), nullptr, read, seek, size};

}  // namespace

extern "C" {

/// Memory for that many bytes more, which the caller fills; null if there is none.
std::uint8_t* gicodec_source_grow(std::size_t bytes) {
  if (bytes > SIZE_MAX / 2 - arrived.size) return nullptr;
  const std::size_t wanted = arrived.size + bytes;
  if (wanted > arrived.capacity) {
    const std::size_t capacity = std::max(wanted, arrived.capacity + arrived.capacity / 2);
    void* const moved = std::realloc(arrived.bytes, capacity);
    if (moved == nullptr) return nullptr;
    arrived.bytes = static_cast<std::uint8_t*>(moved);
    arrived.capacity = capacity;
  }
  std::uint8_t* const free = arrived.bytes + arrived.size;
  arrived.size = wanted;
  return free;
}

/// What gicodec_player_open() takes, from its first byte on.
const gicodec_source* gicodec_source_arrived() {
  arrived.at = 0;
  return &kSource;
}

}  // extern "C"

// The standard library's way to say that it cannot go on, without the text, which takes 20 kB.
_LIBCPP_BEGIN_NAMESPACE_STD
[[noreturn]] void __libcpp_verbose_abort(const char*, ...) { __builtin_trap(); }
_LIBCPP_END_NAMESPACE_STD
