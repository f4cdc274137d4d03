// Where the library's buffers come from.
#pragma once

#include <gicodec/api.h>
#include <gicodec/status.h>

#include <cstddef>

namespace GICODEC_API gicodec {

/// An engine's allocator. May be called by several threads.
struct MemoryHook {
  /// `bytes` of memory, aligned to a power of two; null if there are none, which calls answer with
  /// Status::out_of_memory. Throws nothing.
  void* (*allocate)(void* self, std::size_t bytes, std::size_t alignment) = nullptr;
  /// What allocate() gave for that alignment; never null.
  void (*release)(void* self, void* memory, std::size_t alignment) = nullptr;
  void* self = nullptr;  ///< must outlive the program's last buffer
};

/// From now on all that grows with textures comes from there: records, mirrors and histories, and
/// what coding needs, zstd's and LZ4's contexts included. What is handed out (packets, messages,
/// frames) and what is small comes from operator new, as everything does without a hook; so does
/// what other backends need. Call it first: out_of_order while there are buffers; invalid_argument
/// where a function is missing. An empty hook takes it back.
Status set_memory(const MemoryHook& hook) noexcept;

}  // namespace gicodec
