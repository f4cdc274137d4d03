// How many threads a call uses, and where they come from.
#pragma once

#include <gicodec/api.h>

namespace GICODEC_API gicodec {

/// Runs work on several threads, e.g. those of an engine's job system. Several threads may call it
/// at once, those that it runs work on among them.
struct Executor {
  /// Calls work(context, i) once for every i below `count`, in any order, on any threads including
  /// the caller's. Returns when all calls have returned. Work for which no thread is free runs
  /// later. Must not throw. Null: own_threads().
  void (*run)(void* self, unsigned count, void (*work)(void* context, unsigned i) noexcept,
              void* context) = nullptr;
  void* self = nullptr;  ///< must outlive all that was created with it
};

inline constexpr unsigned kMaxThreads = 256;

/// The caller's thread and `count` - 1 others, 1..kMaxThreads. Results do not depend on `count`.
struct Threads {
  constexpr Threads(unsigned count_in = 1, Executor executor_in = {}) noexcept  // NOLINT
      : count(count_in), executor(executor_in) {}

  unsigned count;
  Executor executor;  ///< runs the others
};

/// The library's own threads, shared by all that has no executor. The library starts them when a
/// call first needs them: as many as the machine has processors, or as one call asks for. They
/// sleep when idle and end with the process. A program that unloads a module with the library in it
/// must give an executor instead. If no thread can be started, the caller's thread does all work.
[[nodiscard]] Executor own_threads() noexcept;

}  // namespace gicodec
