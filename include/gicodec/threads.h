// On how many threads calls do their work, and whose threads they are.
#pragma once

#include <gicodec/api.h>

namespace GICODEC_API gicodec {

/// Runs work on several threads, e.g. on those of an engine's job system. May be called by several
/// threads, and by those that it runs work on.
struct Executor {
  /// Calls work(context, i) once for every i below `count`, in any order and on any threads, the
  /// caller's among them, and returns when all calls have returned. Throws nothing; what cannot run
  /// beside the rest runs after it. Null: own_threads().
  void (*run)(void* self, unsigned count, void (*work)(void* context, unsigned i) noexcept,
              void* context) = nullptr;
  void* self = nullptr;  ///< must outlive what was created with it
};

inline constexpr unsigned kMaxThreads = 256;

/// The caller's thread and `count` - 1 others, 1..kMaxThreads. Results do not depend on it.
struct Threads {
  constexpr Threads(unsigned count_in = 1, Executor executor_in = {}) noexcept  // NOLINT
      : count(count_in), executor(executor_in) {}

  unsigned count;
  Executor executor;  ///< of the others
};

/// The library's own threads, which all that is not given an executor shares. They are started when
/// they are first needed, as many as the machine has processors or one call asks for, sleep when
/// there is nothing to do, and end with the process: a program that unloads a module with the
/// library in it gives an executor instead. Where none can be started the caller does all.
[[nodiscard]] Executor own_threads() noexcept;

}  // namespace gicodec
