// An allocator for the library's buffers.
#pragma once

#include <gicodec/api.h>
#include <gicodec/status.h>

#include <cstddef>

namespace GICODEC_API gicodec {

/// An engine's allocator. Several threads may call it at once.
struct MemoryHook {
  /// Returns `bytes` of memory, aligned to a power of two, or null, upon which the library's call
  /// fails with out_of_memory. Must not throw.
  void* (*allocate)(void* self, std::size_t bytes, std::size_t alignment) = nullptr;
  /// Frees what allocate() returned for that alignment; never null.
  void (*release)(void* self, void* memory, std::size_t alignment) = nullptr;
  void* self = nullptr;  ///< must outlive the program's last buffer
};

/// Sets the allocator of all memory that grows with textures: records, mirrors, histories, and
/// working memory of coding, the contexts of zstd and LZ4 included. Operator new still allocates
/// what callers get (packets, messages, frames), small objects, and the memory of other backends.
/// Call it before anything else. out_of_order while buffers exist; invalid_argument if a function
/// is missing. An empty hook restores operator new.
Status set_memory(const MemoryHook& hook) noexcept;

}  // namespace gicodec
